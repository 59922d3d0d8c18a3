// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/tools/run/starts.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "agent/capture/source.h"
#include "common/base/log.h"
#include "common/base/text.h"
#include "common/dataset/file.h"
#include "common/dataset/result.h"
#include "common/dataset/result_folder.h"
#include "deploy/tools/run/sound.h"
#include "deploy/tools/run/turning.h"

namespace coslam {
namespace {

namespace fs = std::filesystem;

constexpr double kWorthARun_s = 0.05;

// A video whose images are dated by its container, as its sound is.
std::optional<Sound> sound_of_source(const std::string& source) {
  constexpr double kAnyRate_hz = 30;
  if (!fs::is_regular_file(source) || first_file(source, kAnyRate_hz) != source) return std::nullopt;
  for (fs::path sidecar : {fs::path(source), fs::path(source).replace_extension()}) {
    sidecar += ".timestamps.csv";
    if (fs::exists(sidecar)) return std::nullopt;
  }
  return sound_of(source);
}

std::string seconds(double s) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f s", s);
  return text;
}

std::string in_quotes(const std::string& text) { return nlohmann::json(text).dump(); }  // JSON's strings are YAML's

// The map in which an agent was longest.
Trajectory longest_path(const ResultContents& contents, const std::string& agent) {
  Trajectory longest;
  for (const ResultMap& map : contents.maps) {
    if (!fs::exists(map.folder.trajectory(agent))) continue;
    Trajectory path = load_tum(map.folder.trajectory(agent));
    if (path.size() > longest.size()) longest = std::move(path);
  }
  return longest;
}

}  // namespace

std::string_view words_of(StartFrom from) {
  switch (from) {
    case StartFrom::kGiven:
      return "given";
    case StartFrom::kSound:
      return "sound";
    case StartFrom::kWhatMoves:
      return "what moves";
    case StartFrom::kTurning:
      return "how cameras turn";
    case StartFrom::kNothing:
      return "nothing";
  }
  return "";
}

Starts::Starts(Sequence* sequence) : sequence_(*sequence) {
  std::vector<SequenceAgent>& agents = sequence_.agents;
  if (std::ranges::all_of(agents, &SequenceAgent::start_is_open)) agents.front().start_is_open = false;
  for (const SequenceAgent& a : agents) from_[a.name] = a.start_is_open ? StartFrom::kNothing : StartFrom::kGiven;
  last_given_s_ = -std::numeric_limits<double>::infinity();
  for (const SequenceAgent& a : agents) {
    if (!a.start_is_open) last_given_s_ = std::max(last_given_s_, a.start_s);
  }
  if (!any_open()) return;
  std::vector<std::optional<Sound>> sounds;
  for (const SequenceAgent& a : agents) sounds.push_back(sound_of_source(a.source));
  for (std::size_t i = 0; i < agents.size(); ++i) {
    for (std::size_t j = 0; j < agents.size() && !tied(agents[i].name); ++j) {
      if (!sounds[i] || !sounds[j] || !tied(agents[j].name)) continue;
      const auto later_s = began_later_s(sounds[j]->samples, sounds[i]->samples, Sound::kRate_hz);
      if (!later_s) continue;
      const double images_later_s = *later_s + sounds[j]->begins_s - sounds[i]->begins_s;
      tie(agents[i].name, agents[j].name, agents[j].start_s - images_later_s, StartFrom::kSound);
    }
  }
  play_all();
}

bool Starts::any_open() const { return std::ranges::any_of(sequence_.agents, &SequenceAgent::start_is_open); }

void Starts::tie(const std::string& agent, const std::string& against, double start_s, StartFrom from) {
  const auto named = [&](const std::string& name) -> SequenceAgent& {
    return *std::ranges::find(sequence_.agents, name, &SequenceAgent::name);
  };
  constexpr double kPerSecond = 1000;  // steps that are worth writing down
  start_s = std::round(start_s * kPerSecond) / kPerSecond;
  named(agent).start_s = start_s;
  from_[agent] = from;
  const double later_s = named(against).start_s - start_s;
  log_info(agent + " began " + seconds(std::abs(later_s)) + (later_s < 0 ? " before " : " after ") + against + ": " +
           (from == StartFrom::kSound       ? "both heard the same"
            : from == StartFrom::kWhatMoves ? "both see the same things move"
                                            : "both turn alike"));
}

void Starts::play_all() {
  const double last_s = std::ranges::max(sequence_.agents, {}, &SequenceAgent::start_s).start_s;
  for (SequenceAgent& a : sequence_.agents) a.start_s -= std::max(0.0, last_s - last_given_s_);
}

bool Starts::improve(const fs::path& result) {
  if (!any_open() || !fs::exists(ResultFolder(result).report())) return false;
  const nlohmann::json report = read_json(ResultFolder(result).report());
  const ResultContents contents = contents_of(ResultFolder(result));
  const std::vector<SequenceAgent> played = sequence_.agents;
  const auto played_start_s = [&](const std::string& name) {
    return std::ranges::find(played, name, &SequenceAgent::name)->start_s;
  };
  bool worth_it = false;
  for (std::size_t i = 0; i < played.size(); ++i) {
    const std::string& name = played[i].name;
    if (!played[i].start_is_open || from_.at(name) == StartFrom::kSound) continue;
    std::optional<double> lag_s;
    std::string against;
    StartFrom from = StartFrom::kWhatMoves;
    if (const auto lag = report.value(nlohmann::json::json_pointer("/agents/" + name + "/lag"), nlohmann::json());
        lag.is_object()) {
      lag_s = lag["lag_s"].get<double>();
      against = lag["against"].get<std::string>();
    }
    for (std::size_t j = 0; j < played.size() && !lag_s; ++j) {
      if (j == i || !tied(played[j].name)) continue;
      from = StartFrom::kTurning;
      against = played[j].name;
      lag_s = lag_by_turning_s(longest_path(contents, against), longest_path(contents, name));
    }
    if (!lag_s || !tied(against)) continue;
    const double against_moved_s =
        std::ranges::find(sequence_.agents, against, &SequenceAgent::name)->start_s - played_start_s(against);
    tie(name, against, played[i].start_s - *lag_s + against_moved_s, from);
    worth_it |= std::abs(*lag_s) > kWorthARun_s;
  }
  play_all();
  return worth_it;
}

void Starts::warn() const {
  for (const SequenceAgent& a : sequence_.agents) {
    if (tied(a.name)) continue;
    log_warn("nothing tells when " + a.name + " began: it is played as if it had been started together with " +
             sequence_.agents.front().name + "; a start_s in a sequence's YAML file says it");
  }
}

void Starts::write(const fs::path& result) const {
  const ResultFolder folder(result);
  if (!fs::exists(folder.report())) return;
  std::ifstream written(folder.report());
  auto report = nlohmann::ordered_json::parse(written);
  std::string text = "# What was played, with what was found about it: for coslam run, the next time.\nname: " +
                     in_quotes(sequence_.name) + "\nagents:\n";
  for (const SequenceAgent& a : sequence_.agents) {
    if (report["agents"].contains(a.name)) {
      report["agents"][a.name]["start_s"] = a.start_s;
      report["agents"][a.name]["start_by"] = words_of(from_.at(a.name));
    }
    text += "  - name: " + in_quotes(a.name) + "\n    source: " + in_quotes(fs::absolute(a.source).string()) + "\n";
    if (fs::exists(folder.calibration(a.name)))
      text += "    calibration: " + in_quotes("calibration/" + a.name + ".yaml") + "\n";
    text += "    start_s: " + (tied(a.name) ? format_double(a.start_s) : "auto") + "\n";
  }
  write_json(folder.report(), report);
  if (!sequence_.file.empty()) return;
  auto stream = create_file(folder.sequence());
  stream << text;
  close_file(stream, folder.sequence());
}

}  // namespace coslam
