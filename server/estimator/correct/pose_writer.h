// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "common/model/agent_pose.h"
#include "server/estimator/map/map.h"
#include "server/estimator/pipeline/stage.h"

namespace coslam {

// Where the cameras of a frame set are after it, for everybody who wants to know. The covariance is what the agent
// knows of its own pose.
std::vector<AgentPose> agent_poses(const Map& map, const FrameSet& set, RunId server_run,
                                   const std::function<bool(MapId)>& in_metres);

}  // namespace coslam
