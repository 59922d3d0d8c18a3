// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/dataset/sequence.h"

#include <algorithm>
#include <regex>
#include <set>

#include "common/base/error.h"
#include "common/base/file_kind.h"
#include "common/config/rigs.h"
#include "common/config/yaml_value.h"
#include "common/dataset/calibration.h"
#include "common/dataset/live_topic.h"
#include "common/dataset/recorded_topic.h"

namespace coslam {
namespace {

namespace fs = std::filesystem;

constexpr double kMaxSeconds = 1e9;
constexpr double kMostLater_s = 3600;  // that a source plays later than the others

// Paths are relative to the file that names them.
fs::path existing_path(const YamlValue& value) {
  fs::path path = (fs::absolute(value.file()).parent_path() / value.text()).lexically_normal();
  if (!fs::exists(path)) value.fail("there is no " + path.string());
  return path;
}

// A path, or bag:PATH#TOPIC.
fs::path existing_path_or_topic(const YamlValue& value) {
  const std::string text = value.text();
  if (!names_recorded_topic(text)) return existing_path(value);
  RecordedTopic topic = recorded_topic(text, fs::absolute(value.file()).parent_path());
  topic.path = topic.path.lexically_normal();
  if (!fs::exists(topic.path)) value.fail("there is no " + topic.path.string());
  return topic.name();
}

fs::path existing_calibration(const YamlValue& value) {
  if (names_recorded_topic(value.text())) return existing_path_or_topic(value);
  if (value.text().starts_with(kRos2Scheme)) return value.text();
  fs::path name = (fs::absolute(value.file()).parent_path() / value.text()).lexically_normal();
  const fs::path file = calibration_file(name).file;
  if (!fs::exists(file)) value.fail("there is no " + file.string());
  return name;
}

std::optional<fs::path> optional_path(const YamlValue& parent, const std::string& key) {
  const auto value = parent.find(key);
  return value ? std::optional(existing_path(*value)) : std::nullopt;
}

constexpr std::size_t kMaxLength = 32;
constexpr std::string_view kAllowed = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.";

bool is_agent_name(std::string_view name) {
  return !name.empty() && name.size() <= kMaxLength && name.front() != '.' &&
         name.find_first_not_of(kAllowed) == std::string_view::npos;
}

std::string agent_name(const YamlValue& value) {
  std::string name = value.text();
  if (!is_agent_name(name)) {
    value.fail("'" + name + "' must be 1 to 32 letters, digits, '_', '-' or '.', not starting with '.'");
  }
  return name;
}

std::vector<TimeSpan> read_spans(const YamlValue& value) {
  std::vector<TimeSpan> spans;
  for (const YamlValue& item : value.items()) {
    const std::vector<double> ends = item.numbers();
    if (ends.size() != 2 || !(ends[0] >= 0 && ends[0] < ends[1] && ends[1] <= kMaxSeconds)) {
      item.fail("must be [FROM, TO], seconds, the second later than the first");
    }
    spans.push_back({ends[0], ends[1]});
  }
  return spans;
}

SequenceAgent read_agent(const YamlValue& value) {
  value.allow_only({"name", "source", "calibration", "start_s", "duration_s", "covered", "mask", "truth"});
  SequenceAgent agent;
  agent.name = agent_name(value.at("name"));
  const YamlValue source = value.at("source");
  agent.source = is_live_source(source.text()) ? source.text() : existing_path_or_topic(source).string();
  if (const auto calibration = value.find("calibration")) agent.calibration = existing_calibration(*calibration);
  if (const auto start = value.find("start_s")) {
    agent.start_is_open = start->text() == "auto";
    if (agent.start_is_open && is_live_source(agent.source)) start->fail("auto is for recordings");
    if (!agent.start_is_open) agent.start_s = start->number(-kMostLater_s, kMaxSeconds);
  }
  agent.truth_start_s = agent.start_s;
  if (const auto duration = value.find("duration_s")) {
    agent.duration_s = duration->number(0, kMaxSeconds);
    if (*agent.duration_s == 0) duration->fail("must be more than 0");
  }
  if (const auto covered = value.find("covered")) agent.covered = read_spans(*covered);
  agent.mask = optional_path(value, "mask");
  agent.truth = optional_path(value, "truth");
  return agent;
}

std::vector<SequenceAgent> read_agents(const YamlValue& value) {
  std::vector<SequenceAgent> agents;
  std::set<std::string> names;
  for (const YamlValue& item : value.items()) {
    agents.push_back(read_agent(item));
    if (!names.insert(agents.back().name).second) {
      item.at("name").fail("'" + agents.back().name + "' is the name of two agents");
    }
  }
  if (agents.empty()) value.fail("at least one agent is needed");
  return agents;
}

// Cameras that are fixed to each other: to the first of each rig.
std::vector<RigCamera> read_rigs(const YamlValue& rigs, const std::vector<SequenceAgent>& agents) {
  std::vector<RigCamera> out;
  std::set<std::string> in_rigs;
  for (const YamlValue& rig : rigs.items()) {
    for (const YamlValue& item : rig.at("cameras").items()) {
      const std::string name = item.text();
      const bool known = std::ranges::any_of(agents, [&](const SequenceAgent& a) { return a.name == name; });
      if (!known) item.fail("there is no agent '" + name + "'");
      if (!in_rigs.insert(name).second) item.fail("'" + name + "' is in two places of the rigs");
    }
    const std::vector<RigCamera> cameras = read_rig(rig);
    out.insert(out.end(), cameras.begin(), cameras.end());
  }
  return out;
}

}  // namespace

bool is_live_source(std::string_view source) {
  for (const std::string_view scheme : {std::string_view("v4l2:"), std::string_view("gst:"), kRos2Scheme}) {
    if (source.starts_with(scheme)) return true;
  }
  return source.find("://") != std::string_view::npos;
}

std::string shown_source(const std::string& source) {
  if (!is_live_source(source)) return source;
  // A password that was not escaped may hold what ends a host; a number after a colon is a port.
  static const std::regex user(R"(://(?:[^\s"'/?#:@]*:(?!\d*(?:[/?#\s"']|$))[^\s"']*@|[^\s"'/?#]*@))");
  static const std::regex field(
      R"(((?:^|[?&\s])[\w-]*(?:pw|pwd|pass|passwd|password|passphrase|token|secret|key|auth)=))"
      R"((?:"[^"]*"|'[^']*'|[^&\s]*))",
      std::regex::icase);
  return std::regex_replace(std::regex_replace(source, user, "://***@"), field, "$1***");
}

std::string agent_name_like(std::string_view text) {
  std::string name(text.substr(0, kMaxLength));
  std::ranges::replace_if(
      name, [](char c) { return kAllowed.find(c) == std::string_view::npos; }, '_');
  return is_agent_name(name) ? name : "cam";
}

Sequence load_sequence(const fs::path& path) {
  if (!fs::exists(path))
    throw UserError(path.string() +
                    ": there is no such sequence; a sequence is a YAML file or a folder with sequence.yaml");
  Sequence sequence;
  sequence.file = fs::is_directory(path) ? path / "sequence.yaml" : path;
  if (!fs::exists(sequence.file))
    throw UserError(path.string() + ": the folder has no sequence.yaml" + but_it_is(path));

  const YamlValue root = YamlValue::load(sequence.file);
  root.allow_only(
      {"name", "rate_hz", "scale", "agents", "truth_points", "masks", "overlap", "rigs", "scene", "scene_seed"});
  const auto name = root.find("name");
  sequence.name = name ? name->text() : fs::absolute(sequence.file).stem().string();
  const auto rate = root.find("rate_hz");
  sequence.rate_is_given = rate.has_value();
  if (rate) sequence.rate_hz = rate->number(0.01, 1000);
  if (const auto scale = root.find("scale")) {
    scale->allow_only({"baseline_m", "tag_m", "tag_family"});
    const auto tag = scale->find("tag_m");
    if (tag && scale->find("baseline_m")) tag->fail("give baseline_m or tag_m, not both");
    if (tag) {
      sequence.tag_m = tag->number(0.001, 10);
      if (const auto family = scale->find("tag_family")) sequence.tag_family = family->text();
    } else {
      scale->allow_only({"baseline_m"});
      sequence.baseline_m = scale->at("baseline_m").number(1e-6, 1e6);
    }
  }
  sequence.agents = read_agents(root.at("agents"));
  if (const auto rigs = root.find("rigs")) {
    if (sequence.baseline_m || sequence.tag_m) rigs->fail("rigs tell lengths: leave out scale");
    sequence.rigs = read_rigs(*rigs, sequence.agents);
  }
  sequence.truth_points = optional_path(root, "truth_points");
  sequence.masks = optional_path(root, "masks");
  sequence.overlap = optional_path(root, "overlap");
  if (const auto scene = root.find("scene")) sequence.scene = scene->text();
  if (const auto seed = root.find("scene_seed")) {
    if (seed->integer() < 0) seed->fail("must not be negative");
    sequence.scene_seed = static_cast<std::uint64_t>(seed->integer());
  }
  return sequence;
}

}  // namespace coslam
