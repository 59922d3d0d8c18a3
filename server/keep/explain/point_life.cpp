// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <utility>

#include "server/keep/explain/life.h"
#include "server/keep/explain/sentence.h"

namespace coslam::explain {
namespace {

constexpr const char* kPhase = "phase";
constexpr const char* kMap = "map";
constexpr const char* kGone = "no longer in the map";

// The life of one point until it became part of another, by the events before `end`.
class OwnLife {
 public:
  OwnLife(const EventLog& log, PointId point, At end) : log_(log), point_(point) {
    const std::vector<At>& events = log.of_point.at(point);
    auto of_map = log.of_maps.begin();
    for (const At at : events) {
      if (at >= end) break;
      for (; of_map != log.of_maps.end() && *of_map < at; ++of_map) take_map(*of_map);
      take(at);
    }
    for (; of_map != log.of_maps.end() && *of_map < end; ++of_map) take_map(*of_map);
  }

  std::vector<Entry> entries;
  std::optional<std::pair<PointId, At>> into;
  bool alive = true;

  // Tracks that follow it in the end, by what their entries say.
  std::vector<std::string> tracks() const {
    std::map<std::string, bool> bound;
    for (const Entry& e : entries) {
      if (!e.aspect.empty() && e.aspect != kPhase && e.aspect != kMap) bound[e.aspect] = !e.now.empty();
    }
    std::vector<std::string> out;
    for (const auto& [track, is] : bound) {
      if (is) out.push_back(track);
    }
    return out;
  }

 private:
  Entry& add(At at, std::string text, std::string aspect = {}, std::string now = {}) {
    entries.push_back({.t_ns = log_.events[at].t_ns,
                       .text = std::move(text),
                       .aspect = std::move(aspect),
                       .now = std::move(now),
                       .at = at});
    return entries.back();
  }
  void add_unsaid(At at, std::string text, std::string aspect, std::string now = {}) {
    add(at, std::move(text), std::move(aspect), std::move(now)).in_text = false;
  }

  void take_map(At at) {
    const Event& e = log_.events[at];
    if (map_ == MapId() || !alive || e.why == Why::kAdjusted) return;
    const bool merged = e.kind == EventKind::kMapMerged && e.from == map_;
    if (!merged && (e.kind != EventKind::kMapMoved || e.map != map_)) return;
    map_ = e.map;
    add(at, map_sentence(e), kMap, "in " + name(map_));
  }

  void take(At at) {
    const Event& e = log_.events[at];
    switch (e.kind) {
      case EventKind::kPointMade:
        return make(at, e);
      case EventKind::kPointBecame:
        add(at, "It became " + words(static_cast<PointPhase>(e.to)) + " " + reason(e), kPhase,
            words(static_cast<PointPhase>(e.to)));
        return;
      case EventKind::kPointFused:
        return e.other == point_ ? become_part(at, e) : take_in(at, e);
      case EventKind::kPointRemoved:
        alive = false;
        add(at, "It was removed " + reason(e), kPhase, kGone);
        return add_unsaid(at, "", kMap);
      default:
        return take_track(at, e);
    }
  }

  void make(At at, const Event& e) {
    const std::string phase = words(static_cast<PointPhase>(e.to));
    map_ = e.map;
    std::string from;
    for (const At next : log_.of_point.at(point_)) {
      const Event& b = log_.events[next];
      if (b.kind != EventKind::kTrackBound || b.why != Why::kMadeFromIt || b.set != e.set) continue;
      from += (from.empty() ? ", of " : " and ") + name(log_, track_of(b));
    }
    add(at, "It was made, " + phase + from + ", " + reason(e), kPhase, phase);
    add_unsaid(at, "", kMap, "in " + name(map_));
  }

  void take_in(At at, const Event& e) {
    const OwnLife other(log_, e.other, at + 1);  // a file may have each become part of the other
    const std::string subject = "Point " + std::to_string(e.other.value);
    const TimeNs made_ns = other.entries.empty() ? 0 : other.entries.front().t_ns;
    add(at, subject + ", made at " + seconds(log_, made_ns) + ", became part of it " + reason(e));
    for (const std::string& track : other.tracks()) add_unsaid(at, track + " came with " + name(e.other), track, track);
  }

  void become_part(At at, const Event& e) {
    alive = false;
    into = {e.point, at};
    add(at, "It became part of " + name(e.point) + " " + reason(e) + "; what follows is the life of " + name(e.point));
  }

  void take_track(At at, const Event& e) {
    const std::string track = name(log_, track_of(e));
    if (e.kind == EventKind::kTrackBound) {
      add(at, track + " was bound to it " + reason(e), track, track).in_text = e.why != Why::kMadeFromIt;
    } else if (e.kind == EventKind::kTrackUnbound) {
      add(at, track + " was unbound " + reason(e), track).in_text = e.why != Why::kPointGone;
    } else if (e.kind == EventKind::kTrackEnded) {
      add(at, track + " ended " + reason(e), track);
    } else if (e.kind == EventKind::kTrackMissed) {
      Entry& entry = add(at, miss_sentence(track, e));
      entry.fold = "misses of " + track;
      if (e.why == Why::kOutsideGate) entry.sigmas = e.figures[1];
    }
  }

  const EventLog& log_;
  PointId point_;
  MapId map_;
};

// What was so of a point that became part of another is so no more.
void end_aspects(std::vector<Entry>* entries, At at) {
  std::map<std::string, bool> held;
  for (const Entry& e : *entries) {
    if (!e.aspect.empty()) held[e.aspect] = !e.now.empty();
  }
  for (const auto& [aspect, holds] : held) {
    if (holds) entries->push_back({.aspect = aspect, .at = at, .in_text = false});
  }
}

}  // namespace

std::optional<Life> life_of_point(const EventLog& log, PointId point) {
  if (!log.of_point.contains(point)) return std::nullopt;
  Life life{.subject = name(point), .last = point};
  At begin = 0;
  for (bool again = false;; again = true) {
    OwnLife own_life(log, life.last, log.events.size());
    for (Entry& e : own_life.entries) {
      if (e.at <= begin && begin > 0) {  // before the other became part of it: nothing of this life yet
        e.at = begin;
        e.in_text = false;
      }
      life.entries.push_back(std::move(e));
    }
    life.alive = own_life.alive;
    if (!own_life.into || (again && own_life.into->second <= begin)) return life;
    begin = own_life.into->second;
    end_aspects(&life.entries, begin);
    life.last = own_life.into->first;
  }
}

}  // namespace coslam::explain
