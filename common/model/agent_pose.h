// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>

#include "common/base/ids.h"
#include "common/base/time.h"
#include "common/geometry/rigid3.h"
#include "common/model/track_frame.h"

namespace coslam {

// Pose of an agent in the server's map, for whoever steers by it.
struct AgentPose {
  std::string agent;
  RunId agent_run, server_run;
  TimeNs t_ns = 0;  // capture time
  MapId map;        // 0: in none
  MapEpoch epoch;
  PoseState state = PoseState::kNone;
  bool scale_known = false;
  Rigid3 map_from_cam;  // valid when the state is kTracked
  // Order x y z, turns about the axes of the map; 0: not known.
  Eigen::Matrix<float, 6, 6> covariance = Eigen::Matrix<float, 6, 6>::Zero();
};

}  // namespace coslam
