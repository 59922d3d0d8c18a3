// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>

#include "common/base/time.h"
#include "common/geometry/rigid3.h"

namespace coslam {

// The odom frames of REP 105: each agent moves in one of its own without a jump, and whatever corrects its pose in the
// map moves that frame in the map instead. It begins at the agent's first pose: x ahead, y left, z up of the camera.
class OdomFrames {
 public:
  // cam_from_map of an earlier instant, as the map has it by now; empty: none, or of another map.
  using PoseAt = std::function<std::optional<Rigid3>(TimeNs capture_ns)>;

  // cam_from_odom of the agent's next pose. Where the pose before it is not known any more, the camera is taken to have
  // stood still.
  Rigid3 follow(const std::string& agent, TimeNs capture_ns, const Rigid3& cam_from_map, const PoseAt& pose_at);

 private:
  struct Newest {
    TimeNs capture_ns = 0;
    Rigid3 cam_from_odom;
  };
  std::map<std::string, Newest> newest_;
};

}  // namespace coslam
