// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/keep/explain/life.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <utility>

#include "server/keep/explain/sentence.h"

namespace coslam::explain {
namespace {

std::string line(const EventLog& log, TimeNs t_ns, const std::string& text) {
  char time[32];
  std::snprintf(time, sizeof time, "%10.3f s  ", log.seconds(t_ns));
  return time + text + ".\n";
}

std::string folded(const EventLog& log, const std::vector<const Entry*>& same) {
  const Entry& first = *same.front();
  if (same.size() == 1) return line(log, first.t_ns, first.text);
  std::optional<double> most;
  for (const Entry* e : same) {
    if (e->sigmas) most = std::max(most.value_or(0), *e->sigmas);
  }
  return line(log, first.t_ns,
              first.text + ", the first of " + std::to_string(same.size()) + " times until " +
                  seconds(log, same.back()->t_ns) + (most ? ", by up to " + number(*most) + " sigma" : ""));
}

// Repeated ones that nothing else comes between, in the order of the first of each.
std::string told_run(const EventLog& log, const std::vector<const Entry*>& run) {
  std::vector<std::vector<const Entry*>> groups;
  for (const Entry* e : run) {
    const auto group = std::ranges::find_if(groups, [&](const auto& g) { return g.front()->fold == e->fold; });
    if (group == groups.end()) {
      groups.push_back({e});
    } else {
      group->push_back(e);
    }
  }
  std::string text;
  for (const auto& group : groups) text += folded(log, group);
  return text;
}

using Aspects = std::map<std::string, const Entry*>;

bool is_track(const std::string& aspect) { return aspect.find('/') != std::string::npos; }

std::string state_words(const Aspects& is) {
  std::string text, tracks;
  for (auto at = is.rbegin(); at != is.rend(); ++at) {  // phase before map, pose before place
    if (!is_track(at->first)) text += (text.empty() ? "" : ", ") + at->second->now;
  }
  for (const auto& [aspect, entry] : is) {
    if (is_track(aspect)) tracks += (tracks.empty() ? ", followed by " : " and ") + entry->now;
  }
  return text + tracks;
}

std::string lines(const EventLog& log, const Aspects& is) {
  std::vector<const Entry*> why;
  for (const auto& [aspect, entry] : is) {
    if (!entry->text.empty()) why.push_back(entry);
  }
  std::ranges::stable_sort(why, {}, [](const Entry* e) { return std::pair(e->t_ns, e->at); });
  std::string text;
  for (const Entry* e : why) text += line(log, e->t_ns, e->text);
  return text;
}

}  // namespace

std::string life_text(const EventLog& log, const Life& life) {
  std::string text;
  std::vector<const Entry*> run;
  for (const Entry& e : life.entries) {
    if (!e.in_text) continue;
    if (!e.fold.empty()) {
      run.push_back(&e);
      continue;
    }
    text += told_run(log, run);
    run.clear();
    text += line(log, e.t_ns, e.text);
  }
  return text + told_run(log, run);
}

std::string told_at(const EventLog& log, const Life& life, TimeNs t_ns) {
  const auto end = std::ranges::upper_bound(log.events, t_ns, {}, &Event::t_ns);
  const auto cut = static_cast<At>(end - log.events.begin());
  Aspects is;
  for (const Entry& e : life.entries) {
    if (e.at < cut && !e.aspect.empty()) is[e.aspect] = &e;
  }
  std::erase_if(is, [](const auto& entry) { return entry.second->now.empty(); });
  const std::string at = "At " + seconds(log, t_ns) + " " + life.subject;
  if (is.empty()) {
    std::string text = at + " was not there yet.\n";
    const auto first = std::ranges::find(life.entries, true, &Entry::in_text);
    return first == life.entries.end() ? text : text + line(log, first->t_ns, first->text);
  }
  return at + " was " + state_words(is) + ".\n" + lines(log, is);
}

}  // namespace coslam::explain
