// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/sequence_argument.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string_view>

#include "common/base/error.h"
#include "common/dataset/result.h"
#include "deploy/coslam/console.h"
#include "deploy/coslam/run/sources.h"
#include "deploy/simulation/scene.h"

namespace coslam {

Sequence sequence_argument(const std::string& text) {
  constexpr std::string_view kSimulated = "sim:";
  if (!text.starts_with(kSimulated)) return load_sequence(text);
  RenderOptions options;
  options.scene = text.substr(kSimulated.size());
  Progress progress("rendering " + options.scene);
  return load_sequence(cached_sequence(options, std::ref(progress)));
}

Sequence sequence_argument(const std::vector<std::string>& texts) {
  return texts.size() == 1 && names_sequence(texts.front()) ? sequence_argument(texts.front())
                                                            : sequence_of_sources(texts);
}

Sequence as_played(Sequence sequence, const ResultFolder& result) {
  if (!std::filesystem::exists(result.report())) return sequence;
  const nlohmann::json report = read_json(result.report());
  for (SequenceAgent& agent : sequence.agents) {
    const auto start =
        report.value(nlohmann::json::json_pointer("/agents/" + agent.name + "/start_s"), nlohmann::json());
    if (start.is_number()) agent.begin_at(start.get<double>());
  }
  return sequence;
}

std::string no_such_agent(const Sequence& sequence, const std::string& name) {
  std::string text = "the sequence " + sequence.name + " has no agent '" + name + "', its agents are";
  for (const SequenceAgent& a : sequence.agents) text += " " + a.name;
  return text;
}

void add_cover_option(CLI::App& command, CoverArguments& covered) {
  command.add_option("--cover", covered, "this agent's lens is covered for this time, in seconds; may be repeated")
      ->type_name("AGENT FROM TO");
}

void cover_lenses(Sequence& sequence, const CoverArguments& covered) {
  for (const auto& [name, from_s, to_s] : covered) {
    const auto at = std::find_if(sequence.agents.begin(), sequence.agents.end(),
                                 [&name = name](const SequenceAgent& a) { return a.name == name; });
    if (at == sequence.agents.end()) throw UsageError(no_such_agent(sequence, name));
    if (from_s < 0 || to_s <= from_s) throw UsageError("--cover: the second time must be later than the first");
    at->covered.push_back({from_s, to_s});
  }
}

}  // namespace coslam
