// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "common/model/agent_pose.h"
#include "server/estimator/map/map.h"
#include "server/estimator/pipeline/stage.h"

namespace coslam {

// Returns the poses of the cameras of a frame set for publication. The covariance is the agent's own estimate.
std::vector<AgentPose> agent_poses(const Map& map, const FrameSet& set, RunId server_run,
                                   const std::function<bool(MapId)>& in_metres);

}  // namespace coslam
