// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/run/sources.h"

#include <algorithm>
#include <filesystem>
#include <string_view>

#include "agent/capture/image_names.h"
#include "common/base/error.h"
#include "common/base/file_kind.h"
#include "common/dataset/recorded_topic.h"

namespace coslam {
namespace {

namespace fs = std::filesystem;

// What tells it from others: a topic, a device, a host and what follows it, or a file's name. No password.
std::string distinctive_part(const std::string& source) {
  if (names_recorded_topic(source)) {
    const RecordedTopic named = recorded_topic(source);
    return named.topic.empty() ? named.path.stem().string() : named.topic;
  }
  if (!is_live_source(source)) {
    const fs::path path(source);
    return (path.filename().empty() ? path.parent_path() : path).stem().string();
  }
  const std::string_view text = std::string_view(source).substr(source.find(':') + 1);
  const std::string_view address = text.substr(0, text.find('?'));
  const std::size_t password = address.rfind('@');
  return std::string(password == std::string_view::npos ? address : address.substr(password + 1));
}

// Two of one name are told apart by a number, for which there is room.
std::string agent_name(const std::string& source, const std::vector<SequenceAgent>& agents) {
  constexpr std::size_t kMost = 28;
  const std::string part = distinctive_part(source);
  const std::size_t begin = std::min(part.find_first_not_of('/'), part.size());
  const std::string name = agent_name_like(part.substr(begin, kMost));
  const auto taken = [&](const std::string& n) {
    return std::ranges::any_of(agents, [&](const SequenceAgent& a) { return a.name == n; });
  };
  std::string free_name = name;
  for (int i = 2; taken(free_name); ++i) free_name = name + "-" + std::to_string(i);
  return free_name;
}

std::string existing_source(const std::string& text) {
  if (is_live_source(text)) return text;
  if (names_recorded_topic(text)) {
    RecordedTopic topic = recorded_topic(text, fs::current_path());
    topic.path = topic.path.lexically_normal();
    if (!fs::exists(topic.path)) throw UserError(text + ": there is no " + topic.path.string());
    return topic.name();
  }
  if (!fs::exists(text)) throw UserError(text + ": there is no such file or folder");
  if (fs::exists(fs::path(text) / "report.json")) throw UserError(text + ": is no source" + but_it_is(text));
  if (names_sequence(text)) throw UserError(text + ": a sequence is given alone, or else sources, as videos");
  return fs::absolute(text).lexically_normal().string();
}

// Cameras at work have the time of day, and the topics of one recording that of its clock.
bool has_time_of(const SequenceAgent& agent, const SequenceAgent& other) {
  if (is_live_source(agent.source) || is_live_source(other.source)) return true;
  return names_recorded_topic(agent.source) && names_recorded_topic(other.source) &&
         recorded_topic(agent.source).path == recorded_topic(other.source).path;
}

}  // namespace

bool names_sequence(const std::string& text) {
  if (is_live_source(text) || names_recorded_topic(text)) return false;
  const fs::path path(text);
  return text.starts_with("sim:") || path.extension() == ".yaml" || path.extension() == ".yml" ||
         fs::exists(path / "sequence.yaml") || !fs::exists(path);
}

namespace {

// A shell makes a file each of `folder/*.jpg`.
void refuse_images_one_by_one(const std::vector<std::string>& sources) {
  const auto one = [](const std::string& source) { return is_image(source) && fs::is_regular_file(source); };
  if (sources.size() < 2 || !std::ranges::all_of(sources, one)) return;
  const fs::path folder = fs::path(sources.front()).parent_path();
  throw UserError("each of the " + std::to_string(sources.size()) + " images would be a camera: name their folder, " +
                  (folder.empty() ? "." : folder.string()));
}

}  // namespace

Sequence sequence_of_sources(const std::vector<std::string>& sources) {
  refuse_images_one_by_one(sources);
  Sequence sequence;
  for (const std::string& source : sources) {
    SequenceAgent agent;
    agent.source = existing_source(source);
    agent.name = agent_name(agent.source, sequence.agents);
    agent.start_is_open = !sequence.agents.empty() && !has_time_of(agent, sequence.agents.front());
    sequence.agents.push_back(std::move(agent));
  }
  sequence.name = sequence.agents.front().name;
  return sequence;
}

std::string shared_source(const std::vector<SequenceAgent>& agents) {
  for (const SequenceAgent& a : agents) {
    const auto other = std::ranges::find_if(agents, [&](const SequenceAgent& b) {
      return &b != &a && b.source == a.source && (b.start_s == a.start_s || b.start_is_open);
    });
    if (other != agents.end())
      return a.name + " and " + other->name + " play the same source, " + shown_source(a.source) + ", at the same time";
  }
  return {};
}

}  // namespace coslam
