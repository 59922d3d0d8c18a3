// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/dataset/sequence.h"
#include "deploy/coslam/eval/evaluation.h"

// Whether the truth of an agent is what it seems: each one sentence for the user, or empty.
namespace coslam::eval {

// Why poses cannot be judged by the truth that they have. max_gap_ns: over which truth is interpolated.
std::string why_not_judged(const std::string& agent, const Trajectory& poses, const Trajectory& truth,
                           TimeNs max_gap_ns);

// Whether the truth would fit far better up to a second earlier or later.
std::string doubt_of_times(const AgentPaths& agent, TimeNs max_gap_ns);

// Whether the turns of the truth would fit far better with its quaternions in the other order, or as those of poses
// from the world to the camera. listed: the agent, with its file.
std::string doubt_of_turns(const AgentPaths& agent, const SequenceAgent& listed, double rate_hz);

// Whether the truth is too fast for metres.
std::string doubt_of_unit(const AgentPaths& agent);

}  // namespace coslam::eval
