// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/run/starts.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>

#include "agent/capture/source.h"
#include "common/base/log.h"
#include "common/base/text.h"
#include "common/dataset/file.h"
#include "common/dataset/result.h"
#include "common/dataset/result_folder.h"
#include "deploy/coslam/run/sound.h"
#include "deploy/coslam/run/turning.h"

namespace coslam {
namespace {

namespace fs = std::filesystem;

constexpr double kWorthARun_s = 0.06;
// Sound that repeats itself may fit at a wrong time, which what moves tells.
constexpr double kContradiction_s = 0.15;

// A video whose images are dated by its container, as its sound is.
std::optional<Sound> sound_of_source(const std::string& source) {
  constexpr double kAnyRate_hz = 30;
  if (!fs::is_regular_file(source) || first_file(source, kAnyRate_hz) != source) return std::nullopt;
  if (times_beside(source)) return std::nullopt;
  return sound_of(source);
}

std::string seconds(double s) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f s", s);
  return text;
}

// JSON's strings are YAML's. Throws what the library throws for what is no UTF-8.
std::string in_quotes(const std::string& text) { return nlohmann::json(text).dump(); }

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

SequenceAgent& named(std::vector<SequenceAgent>& agents, const std::string& name) {
  return *std::ranges::find(agents, name, &SequenceAgent::name);
}

bool any_open(const std::vector<SequenceAgent>& agents) {
  return std::ranges::any_of(agents, &SequenceAgent::start_is_open);
}

std::string sequence_text(const Sequence& sequence, const ResultFolder& result, auto&& tied) {
  std::string text = "# What was played, with what was found about it: for coslam run, the next time.\nname: " +
                     in_quotes(sequence.name) + "\nagents:\n";
  for (const SequenceAgent& a : sequence.agents) {
    text += "  - name: " + in_quotes(a.name) + "\n    source: " + in_quotes(a.source) + "\n";
    if (fs::exists(result.calibration(a.name)))
      text += "    calibration: " + in_quotes("calibration/" + a.name + ".yaml") + "\n";
    if (a.mask) {
      const fs::path beside = result.own_body(a.name);
      const bool found = fs::exists(beside) && fs::equivalent(*a.mask, beside);
      text += "    mask: " + in_quotes(found ? "own_body/" + a.name + ".png" : fs::absolute(*a.mask).string()) + "\n";
    }
    text += "    start_s: " + (a.start_is_open && !tied(a.name) ? "auto" : format_double(a.start_s)) + "\n";
  }
  return text;
}

}  // namespace

std::string_view words_of(StartBy start_by) {
  switch (start_by) {
    case StartBy::kGiven:
      return "given";
    case StartBy::kReference:
      return "reference";
    case StartBy::kSound:
      return "sound";
    case StartBy::kTurning:
      return "how cameras turn";
    case StartBy::kWhatMoves:
      return "what moves";
    case StartBy::kNothing:
      return "nothing";
  }
  return "";
}

Starts::Starts(Sequence* sequence) : sequence_(*sequence), asked_(sequence->agents) {
  std::vector<SequenceAgent>& agents = sequence_.agents;
  reference_ =
      any_open(agents) && (sequence_.file.empty() || std::ranges::all_of(agents, &SequenceAgent::start_is_open));
  if (any_open(agents)) {
    std::vector<std::optional<Sound>> sounds;
    sounds.reserve(agents.size());
    for (const SequenceAgent& a : agents) sounds.push_back(sound_of_source(a.source));
    for (std::size_t i = 0; i < agents.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (!sounds[i] || !sounds[j]) continue;
        const auto later_s = began_later_s(sounds[j]->samples, sounds[i]->samples, Sound::kRate_hz);
        if (later_s)
          link({agents[j].name, agents[i].name, *later_s + sounds[j]->begins_s - sounds[i]->begins_s, StartBy::kSound});
      }
    }
  }
  settle(Change::kAny);
}

void Starts::link(const Link& link) {
  std::erase_if(links_, [&](const Link& l) {
    return l.first == link.first && l.second == link.second && l.start_by == link.start_by;
  });
  links_.push_back(link);
}

// From the agents whose start is known to the others, by the best link each time. Of those that no link reaches, the
// first plays as if it had been started together with the first of all, and others may be linked to it. True when a
// source begins at another time than before by what is worth a run.
bool Starts::settle(Change change) {
  std::vector<SequenceAgent> agents = asked_;
  known_.clear();
  for (std::size_t i = 0; i < agents.size(); ++i) {
    if (reference_ && i == 0)
      known_[agents[i].name].start_by = StartBy::kReference;
    else if (!agents[i].start_is_open)
      known_[agents[i].name].start_by = StartBy::kGiven;
  }
  std::ranges::stable_sort(links_, {}, &Link::start_by);
  while (known_.size() < agents.size()) {
    const auto next = std::ranges::find_if(
        links_, [&](const Link& l) { return known_.contains(l.first) != known_.contains(l.second); });
    if (next == links_.end()) {
      const auto left = std::ranges::find_if(agents, [&](const SequenceAgent& a) { return !known_.contains(a.name); });
      known_[left->name].start_by = StartBy::kNothing;
      continue;
    }
    const bool ahead = known_.contains(next->first);
    const std::string &from = ahead ? next->first : next->second, &to = ahead ? next->second : next->first;
    constexpr double kPerSecond = 1000;  // steps that are worth writing down
    const double start_s = named(agents, from).start_s + (ahead ? -next->later_s : next->later_s);
    named(agents, to).start_s = std::round(kPerSecond * start_s) / kPerSecond;
    known_[to] = {next->start_by, from};
  }
  if (reference_) {
    const double last_s = std::ranges::max(agents, {}, &SequenceAgent::start_s).start_s;
    for (SequenceAgent& a : agents) a.start_s -= last_s;
  }
  bool changed = false;
  for (std::size_t i = 0; i < agents.size(); ++i) {
    const SequenceAgent &first = sequence_.agents.front(), &was = sequence_.agents[i];
    const double moved_s = (agents[i].start_s - agents.front().start_s) - (was.start_s - first.start_s);
    changed |= std::abs(moved_s) > kWorthARun_s;
  }
  if (change == Change::kWorthARun && !changed) return false;
  for (std::size_t i = 0; i < agents.size(); ++i) sequence_.agents[i].begin_at(agents[i].start_s);
  return changed;
}

void Starts::link_by_result(const fs::path& result) {
  const nlohmann::json report = read_json(ResultFolder(result).report());
  const ResultContents contents = contents_of(ResultFolder(result));
  std::vector<SequenceAgent>& agents = sequence_.agents;
  std::vector<Trajectory> paths;
  paths.reserve(agents.size());
  for (const SequenceAgent& a : agents) paths.push_back(longest_path(contents, a.name));
  for (std::size_t i = 0; i < agents.size(); ++i) {
    const std::string& name = agents[i].name;
    const auto lag = report.value(nlohmann::json::json_pointer("/agents/" + name + "/lag"), nlohmann::json());
    if (lag.is_object()) {
      const std::string against = lag["against"].get<std::string>();
      const double later_s = named(agents, against).start_s - agents[i].start_s + lag["lag_s"].get<double>();
      std::erase_if(links_, [&](const Link& l) {
        const bool same = l.first == against && l.second == name, turned = l.first == name && l.second == against;
        return (same || turned) && l.start_by == StartBy::kSound &&
               std::abs((same ? l.later_s : -l.later_s) - later_s) > kContradiction_s;
      });
      link({against, name, later_s, StartBy::kWhatMoves});
    }
    for (std::size_t j = 0; j < i; ++j) {
      const auto lag_s = lag_by_turning_s(paths[j], paths[i]);
      if (lag_s) link({agents[j].name, name, agents[j].start_s - agents[i].start_s + *lag_s, StartBy::kTurning});
    }
  }
}

bool Starts::improve(const fs::path& result) {
  if (!any_open(asked_) || !fs::exists(ResultFolder(result).report())) return false;
  link_by_result(result);
  return settle(Change::kWorthARun);
}

void Starts::say() const {
  for (const SequenceAgent& a : sequence_.agents) {
    const Known& known = known_.at(a.name);
    if (known.start_by == StartBy::kNothing) {
      log_warn("nothing tells when " + a.name + " began: it is played as if it had been started together with " +
               sequence_.agents.front().name + "; a start_s in a sequence's YAML file says it");
    } else if (!known.against.empty()) {
      const double later_s = named(sequence_.agents, known.against).start_s - a.start_s;
      log_info(a.name + " began " + seconds(std::abs(later_s)) + (later_s < 0 ? " before " : " after ") +
               known.against + ", by " + std::string(words_of(known.start_by)));
    }
  }
}

void Starts::write(const fs::path& result) const {
  const ResultFolder folder(result);
  if (!any_open(asked_) || !fs::exists(folder.report())) return;
  std::ifstream written(folder.report());
  auto report = nlohmann::ordered_json::parse(written);
  for (const auto& [name, known] : known_) {
    if (report["agents"].contains(name)) report["agents"][name]["start_by"] = words_of(known.start_by);
  }
  write_json(folder.report(), report);
  if (!sequence_.file.empty()) return;
  try {
    const auto tied = [&](const std::string& name) { return known_.at(name).start_by != StartBy::kNothing; };
    const std::string text = sequence_text(sequence_, folder, tied);
    auto stream = create_file(folder.sequence());
    stream << text;
    close_file(stream, folder.sequence());
  } catch (const nlohmann::json::exception&) {
    log_warn(folder.sequence().string() + " is not written: a file name is no UTF-8 text");
  }
}

}  // namespace coslam
