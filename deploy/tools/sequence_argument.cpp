// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/tools/sequence_argument.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string_view>

#include "common/base/error.h"
#include "common/dataset/result.h"
#include "deploy/scene/scene.h"
#include "deploy/tools/console.h"

namespace coslam {

Sequence sequence_argument(const std::string& text) {
  constexpr std::string_view kSimulated = "sim:";
  if (!text.starts_with(kSimulated)) return load_sequence(text);
  RenderOptions options;
  options.scene = text.substr(kSimulated.size());
  Progress progress("rendering " + options.scene);
  return load_sequence(cached_sequence(options, std::ref(progress)));
}

namespace {

bool names_sequence(const std::string& text) {
  const std::filesystem::path path(text);
  return text.starts_with("sim:") || path.extension() == ".yaml" || path.extension() == ".yml" ||
         std::filesystem::exists(path / "sequence.yaml") || !std::filesystem::exists(path);
}

// Two of one name are told apart by a number, for which there is room.
std::string agent_name(const std::filesystem::path& source, const std::vector<SequenceAgent>& others) {
  constexpr std::size_t kMost = 28;
  const std::filesystem::path named = source.filename().empty() ? source.parent_path() : source;
  const std::string name = agent_name_like(named.stem().string().substr(0, kMost));
  const auto taken = [&](const std::string& n) {
    return std::ranges::any_of(others, [&](const SequenceAgent& a) { return a.name == n; });
  };
  std::string own = name;
  for (int i = 2; taken(own); ++i) own = name + "-" + std::to_string(i);
  return own;
}

}  // namespace

Sequence sequence_argument(const std::vector<std::string>& texts) {
  if (texts.size() == 1 && names_sequence(texts.front())) return sequence_argument(texts.front());
  Sequence sequence;
  for (const std::string& text : texts) {
    const std::filesystem::path source(text);
    if (!std::filesystem::exists(source)) throw UserError(text + ": there is no such file or folder");
    if (names_sequence(text))
      throw UserError(text + ": a sequence is given alone, or else videos and folders of images");
    SequenceAgent agent;
    agent.name = agent_name(source, sequence.agents);
    agent.source = std::filesystem::absolute(source).lexically_normal().string();
    agent.start_is_open = !sequence.agents.empty();
    sequence.agents.push_back(std::move(agent));
  }
  sequence.name = sequence.agents.front().name;
  return sequence;
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

void add_cover_option(CLI::App& command, CoverArguments& covered) {
  command.add_option("--cover", covered, "this agent's lens is covered for this time, in seconds; may be repeated")
      ->type_name("AGENT FROM TO");
}

void cover_lenses(Sequence& sequence, const CoverArguments& covered) {
  for (const auto& [name, from_s, to_s] : covered) {
    const auto at = std::find_if(sequence.agents.begin(), sequence.agents.end(),
                                 [&name = name](const SequenceAgent& a) { return a.name == name; });
    if (at == sequence.agents.end()) throw UsageError("the sequence " + sequence.name + " has no agent " + name);
    if (from_s < 0 || to_s <= from_s) throw UsageError("--cover: the second time must be later than the first");
    at->covered.push_back({from_s, to_s});
  }
}

}  // namespace coslam
