// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/export/result_events.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <string>

#include "common/dataset/result.h"
#include "server/keep/explain/event_log.h"
#include "server/keep/explain/sentence.h"

namespace coslam::exporting {
namespace {

using explain::EventLog;
using Names = std::vector<std::string>;

std::string listed(const Names& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    text += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
  }
  return text;
}

// Empty: it is not told by itself.
struct Words {
  const char* kind = "";
  const char* text = "";
};

Words words_of(const Event& e) {
  switch (e.kind) {
    case EventKind::kCameraJoined:
      return e.why == Why::kRestarted ? Words{"restarted", "was started anew"} : Words{"joined", "joined"};
    case EventKind::kCameraLost:
      return {"lost", "is lost"};
    case EventKind::kCameraFound:
      return {"found", "is found again"};
    case EventKind::kCameraPlaced:
      // Those that started a map are told with it.
      if (e.why == Why::kStartedTogether || e.why == Why::kStartedAlone) return {};
      return {"found", "found its place"};
    default:
      return {};
  }
}

void add_of_camera(const EventLog& log, const Event& e, std::vector<PublicEvent>* out) {
  const Words words = words_of(e);
  if (*words.kind == '\0') return;
  const std::string& name = log.name_of(*e.camera);
  std::string text = name + " " + words.text;
  if (e.kind != EventKind::kCameraJoined) text += " " + explain::reason(e);
  out->push_back({e.t_ns, words.kind, text, {name}});
}

void add_of_map(const Event& e, std::vector<PublicEvent>* out) {
  const std::string map = "map " + std::to_string(e.map.value);
  if (e.kind == EventKind::kMapStarted)
    out->push_back({e.t_ns, "map_started", map + " was started " + explain::reason(e), {}});
  if (e.kind == EventKind::kMapMerged) out->push_back({e.t_ns, "maps_joined", explain::map_sentence(e), {}});
  if (e.kind == EventKind::kMapMoved && e.why == Why::kLoopClosed)
    out->push_back({e.t_ns, "loop", map + " was drawn together " + explain::reason(e), {}});
}

using Groups = std::set<Names>;

// All of a group were together in one of the others.
bool was_one(const Names& group, const Groups& groups) {
  return std::ranges::any_of(groups, [&](const Names& o) { return std::ranges::includes(o, group); });
}

void add_changes(TimeNs t_ns, const Groups& before, const Groups& now, std::vector<PublicEvent>* out) {
  for (const Names& group : now) {
    if (group.size() > 1 && !was_one(group, before))
      out->push_back({t_ns, "merge", listed(group) + " share a view now", group});
  }
  for (const Names& group : before) {
    if (group.size() > 1 && !was_one(group, now))
      out->push_back({t_ns, "split", listed(group) + " share no view any more", group});
  }
}

void add_of_groups(const std::filesystem::path& file, std::vector<PublicEvent>* out) {
  Groups before, now;
  TimeNs t_ns = 0;
  for (const ResultGroupRow& row : read_groups(file)) {
    if (row.t_ns != t_ns && !now.empty()) {
      add_changes(t_ns, before, now, out);
      before = std::exchange(now, {});
    }
    t_ns = row.t_ns;
    Names names = row.agents;
    std::ranges::sort(names);
    now.insert(names);
  }
  add_changes(t_ns, before, now, out);
}

}  // namespace

std::vector<PublicEvent> public_events(const ResultFolder& result) {
  std::vector<PublicEvent> events;
  if (std::filesystem::exists(result.events())) {
    const EventLog log = explain::read_event_log(result.events());
    for (const Event& e : log.events) {
      if (e.camera) {
        add_of_camera(log, e, &events);
      } else {
        add_of_map(e, &events);
      }
    }
  }
  if (std::filesystem::exists(result.groups())) add_of_groups(result.groups(), &events);
  std::ranges::stable_sort(events, {}, &PublicEvent::t_ns);
  return events;
}

}  // namespace coslam::exporting
