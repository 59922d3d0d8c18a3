// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/run/played.h"

#include <filesystem>
#include <fstream>

#include "common/base/printed.h"
#include "common/config/config.h"
#include "common/dataset/result.h"
#include "deploy/coslam/run/run.h"

namespace coslam {
namespace {

nlohmann::ordered_json json_of(const SequenceAgent& agent) {
  nlohmann::ordered_json out{{"source", shown_source(agent.source)}, {"start_s", agent.start_s}};
  if (!agent.calibration.empty()) out["calibration"] = agent.calibration.string();
  if (agent.duration_s) out["duration_s"] = *agent.duration_s;
  if (agent.mask) out["mask"] = agent.mask->string();
  return out;
}

}  // namespace

void note_played(const Sequence& sequence, const std::vector<std::string>& sets, const ResultFolder& result) {
  std::ifstream stream(result.report());
  auto report = nlohmann::ordered_json::parse(stream, nullptr, false);  // its keys stay in their order
  if (!report.is_object()) return;
  RunConfig config;
  for (const std::string& s : sets) config::apply_set(config, s);
  auto& played = report["sequence"] = {{"name", sequence.name}, {"file", sequence.file.string()}};
  for (const SequenceAgent& agent : sequence.agents) played["agents"][agent.name] = json_of(agent);
  report["configuration"]["agent"] = config::dump_json(config.agent);
  write_json(result.report(), report);
}

std::string of_another_sequence(const Sequence& sequence, const ResultFolder& result) {
  if (!std::filesystem::exists(result.report())) return "";
  const nlohmann::json report = read_json(result.report());
  const auto played = report.find("sequence");
  if (played == report.end()) return "";
  const std::string name = played->value("name", "");
  if (name == sequence.name) return "";  // it may lie elsewhere by now
  for (const SequenceAgent& agent : sequence.agents) {
    const std::string source =
        played->value(nlohmann::json::json_pointer("/agents/" + agent.name + "/source"), std::string());
    if (source.empty() || source == shown_source(agent.source)) continue;
    return printed("the result is of the sequence %s, whose %s is %s, not ", name.c_str(), agent.name.c_str(),
                   source.c_str()) +
           shown_source(agent.source) + " as in " + sequence.name + ": what is said of it means nothing";
  }
  return "";
}

}  // namespace coslam
