// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/publish/event_feed.h"

#include <algorithm>
#include <cmath>

#include "server/keep/explain/sentence.h"

namespace coslam {
namespace {

using Names = std::vector<std::string>;

Names names_of(const Map& map, const std::vector<CameraId>& cameras) {
  Names names;
  for (const CameraId c : cameras) names.push_back(map.camera(c).name);
  return names;
}

Names names_in(const Map& map, MapId in) {
  Names names;
  for (const MapCamera& c : map.cameras()) {
    if (c.alive && c.map == in) names.push_back(c.name);
  }
  return names;
}

// "cam0, cam1 and cam2"
std::string listed(const Names& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const char* between = i == 0 ? "" : i + 1 == names.size() ? " and " : ", ";
    text += between + names[i];
  }
  return text;
}

// Which of the groups a camera is in; one that is in none is by itself.
int group_in(const std::vector<std::vector<CameraId>>& groups, CameraId camera) {
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (std::ranges::binary_search(groups[g], camera)) return static_cast<int>(g);
  }
  return static_cast<int>(groups.size()) + camera.value;
}

// The members of one group, by the groups that they are in elsewhere.
std::map<int, std::vector<CameraId>> parted(const std::vector<CameraId>& members,
                                            const std::vector<std::vector<CameraId>>& elsewhere) {
  std::map<int, std::vector<CameraId>> parts;
  for (const CameraId c : members) parts[group_in(elsewhere, c)].push_back(c);
  return parts;
}

std::string listed(const Map& map, const std::map<int, std::vector<CameraId>>& parts) {
  Names texts;
  for (const auto& [group, members] : parts) {
    std::string text = listed(names_of(map, members));
    texts.push_back(members.size() > 1 && parts.size() > 1 ? "[" + text + "]" : text);
  }
  return listed(texts);
}

PublicEvent misdated(const Map& map, const Event& e) {
  const std::string name = map.camera(*e.camera).name,
                    other = map.camera(CameraId(static_cast<std::uint16_t>(e.figures[1]))).name;
  return {e.t_ns, "misdated", misdated_sentence(name, other, e.figures[0]), {name, other}};
}

}  // namespace

std::string misdated_sentence(const std::string& agent, const std::string& against, double lag_s) {
  return agent + "'s images seem to be taken " + explain::number(std::abs(lag_s)) + " s " +
         (lag_s > 0 ? "later" : "earlier") + " than they are dated, by what moves in them and in those of " + against +
         ": what moves is not found by both; correct its stamps or clock (in a sequence: so much " +
         (lag_s > 0 ? "less" : "more") + " start_s for it)";
}

std::vector<PublicEvent> EventFeed::comings(const Map& map) {
  std::vector<PublicEvent> out;
  const auto say = [&](const MapCamera& c, const char* kind, const std::string& text) {
    out.push_back({map.now_ns(), kind, c.name + text, {c.name}});
  };
  for (const MapCamera& c : map.cameras()) {
    const auto [at, is_new] = known_.try_emplace(c.id);
    Known& known = at->second;
    const RunId before = known.run;
    if (c.alive && known.run != c.run && !is_new && before != RunId()) {
      say(c, "restarted", " was started anew");
    } else if (c.alive && !known.alive) {
      say(c, "joined", before == c.run ? " is back" : " joined");
    } else if (!c.alive && known.alive) {
      say(c, "left", " left; the others go on");
    }
    if (c.alive && before != c.run) lost_.erase(c.id);
    known.alive = c.alive;
    if (c.alive) known.run = c.run;
  }
  return out;
}

std::vector<PublicEvent> EventFeed::after_set(const Map& map, const Journal& journal, const ViewGraph& graph) {
  std::vector<PublicEvent> out = comings(map);
  for (const Event& e : journal.events()) {
    if (e.camera) {
      of_camera(map, e, &out);
    } else {
      of_map(map, e, &out);
    }
  }
  of_groups(map, graph, &out);
  return out;
}

void EventFeed::of_camera(const Map& map, const Event& e, std::vector<PublicEvent>* out) {
  const auto say = [&](const char* kind, const std::string& text) {
    const std::string& name = map.camera(*e.camera).name;
    out->push_back({e.t_ns, kind, name + " " + text + " " + explain::reason(e), {name}});
  };
  const std::string in_map = explain::name(e.map);
  switch (e.kind) {
    case EventKind::kCameraLost:
      lost_[*e.camera] = "no pose " + explain::reason(e);
      say("lost", "is lost");
      break;
    case EventKind::kCameraLeft:
      lost_[*e.camera] = "it left " + in_map + " " + explain::reason(e);
      break;
    case EventKind::kCameraFound:
      if (lost_.erase(*e.camera) > 0) say("found", "is found again");
      break;
    case EventKind::kCameraPlaced:
      // Those that started a map are told with it.
      if (e.why == Why::kStartedTogether || e.why == Why::kStartedAlone) {
        lost_.erase(*e.camera);
      } else {
        say("found", std::string(lost_.erase(*e.camera) > 0 ? "is found again" : "found its place") + " in " + in_map);
      }
      break;
    case EventKind::kCameraMisdated:
      out->push_back(misdated(map, e));
      break;
    default:
      break;
  }
}

void EventFeed::of_map(const Map& map, const Event& e, std::vector<PublicEvent>* out) {
  const auto say = [&](const char* kind, const std::string& text) {
    out->push_back({e.t_ns, kind, text, names_in(map, e.map)});
  };
  if (e.kind == EventKind::kMapStarted)
    say("map_started", "map " + std::to_string(e.map.value) + " was started " + explain::reason(e));
  if (e.kind == EventKind::kMapMerged) say("maps_joined", explain::map_sentence(e));
  if (e.kind == EventKind::kMapMoved && e.why == Why::kLoopClosed)
    say("loop", explain::name(e.map) + " was drawn together " + explain::reason(e));
}

void EventFeed::of_groups(const Map& map, const ViewGraph& graph, std::vector<PublicEvent>* out) {
  if (graph.groups == groups_) return;
  const auto say = [&](const char* kind, const std::vector<CameraId>& cameras, const std::string& text) {
    out->push_back({map.now_ns(), kind, text, names_of(map, cameras)});
  };
  for (const auto& group : graph.groups) {
    const auto parts = parted(group, groups_);
    if (parts.size() > 1) say("merge", group, listed(map, parts) + " share a view now");
  }
  for (std::vector<CameraId> group : groups_) {
    std::erase_if(group, [&](CameraId c) { return !map.camera(c).alive; });
    const auto parts = parted(group, graph.groups);
    if (parts.size() > 1) say("split", group, listed(map, parts) + " share no view any more");
  }
  groups_ = graph.groups;
}

std::string EventFeed::why_lost(const MapCamera& camera) const {
  if (!camera.alive) return "its agent has ended or is gone";
  const auto lost = lost_.find(camera.id);
  if (lost != lost_.end()) return lost->second;
  return camera.map == MapId() ? "it has no place in any map yet" : "";
}

}  // namespace coslam
