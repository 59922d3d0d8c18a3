// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/agent_report.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/base/log.h"
#include "common/dataset/report_parts.h"

namespace coslam {
namespace {

using Json = nlohmann::ordered_json;

Json own_body(const Agent& agent) {
  const ImageParts parts = agent.own_body();
  std::string cells;
  for (const bool found : parts.cells) cells += found ? '1' : '0';
  // Sorted by name, as the programs that read it are used to.
  return nlohmann::json(
      {{"percent", 100 * agent.own_body_share()}, {"columns", parts.columns}, {"rows", parts.rows}, {"cells", cells}});
}

}  // namespace

std::string agent_report(const Agent& agent, const StageTimes& times, const AgentReportFacts& facts) {
  Json out;
  out["start_s"] = facts.start_s;
  out["frames"] = facts.images;
  out["left_out"] = Json::object();
  for (std::size_t i = 0; i < facts.left_out.size(); ++i) {
    if (facts.left_out[i] > 0) {
      out["left_out"][std::string(words_of(static_cast<ImageFault>(i)).name)] = facts.left_out[i];
    }
  }
  out["live_tracked_percent"] = 100.0 * agent.tracked_frames() / std::max(1U, facts.images);
  out["ms_per_frame"] = mean_frame_ms(agent);
  out["tracked_width_px"] = agent.working_width_px();
  if (agent.own_body_share() > 0) out["own_body"] = own_body(agent);
  out["ms"] = json_of(agent.times());
  out["ms"].update(json_of(times));
  out["peak_memory_mib"] = peak_memory_mib();
  if (facts.with_warnings) out["warnings"] = json_of(warnings_given());
  return out.dump();
}

double mean_frame_ms(const Agent& agent) {
  const auto& stages = agent.times().stages();
  const auto frame = stages.find(Agent::kFrame);
  return frame == stages.end() ? 0 : frame->second.mean_ms();
}

}  // namespace coslam
