// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "agent/agent.h"
#include "common/base/metrics.h"
#include "common/model/image_fault.h"

namespace coslam {

// Facts that the loop of an agent adds to its report.
struct AgentReportFacts {
  double start_s = 0;                                  // position in the source where it began
  std::uint32_t images = 0;                            // images that its camera took
  std::array<std::uint32_t, kImageFaults> left_out{};  // images, by what was wrong with them
  bool with_warnings = false;                          // all warnings of the process are of this agent
};

// What an agent tells its server of its run when it ends: JSON, see docs/configuration.md. times: beside the agent's
// own.
std::string agent_report(const Agent& agent, const StageTimes& times, const AgentReportFacts& facts);

// Mean time that the agent takes for a frame, ms.
double mean_frame_ms(const Agent& agent);

}  // namespace coslam
