// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include "server/keep/explain/life.h"
#include "server/keep/explain/sentence.h"

namespace coslam::explain {
namespace {

constexpr const char* kState = "state";

std::string unbound_state(std::uint8_t motion) {
  switch (static_cast<TrackMotion>(motion)) {
    case TrackMotion::kResting:
      return "unmapped";
    case TrackMotion::kDoubtful:
      return "doubtful";
    case TrackMotion::kMoving:
      break;
  }
  return "moving";
}

std::optional<PointPhase> phase_at(const EventLog& log, PointId point, At at) {
  std::optional<PointPhase> phase;
  for (const At i : log.of_point.at(point)) {
    const Event& e = log.events[i];
    if (i > at || e.point != point) continue;
    if (e.kind == EventKind::kPointMade || e.kind == EventKind::kPointBecame) phase = static_cast<PointPhase>(e.to);
  }
  return phase;
}

class TrackLife {
 public:
  TrackLife(const EventLog& log, const TrackKey& track) : log_(log) {
    At last = 0;
    for (const At at : log.of_track.at(track)) {
      follow_point(last, at);
      take(at);
      last = at;
    }
    follow_point(last, log.events.size());
    std::ranges::stable_sort(entries, {}, &Entry::at);
  }

  std::vector<Entry> entries;
  bool ended = false;

 private:
  void add(At at, std::string text, std::string now) {
    entries.push_back(
        {.t_ns = log_.events[at].t_ns, .text = std::move(text), .aspect = kState, .now = std::move(now), .at = at});
  }
  std::string bound_state(At at) const {
    const bool moves = phase_at(log_, point_, at) == PointPhase::kMoving;
    return moves ? "moving, with " + name(point_) : "mapped, as " + name(point_);
  }

  // What befell its point between two events of its own.
  void follow_point(At after, At before) {
    for (bool another = point_ != PointId(); another;) {
      another = false;
      for (const At at : log_.of_point.at(point_)) {
        if (at <= after || at >= before) continue;
        const Event& e = log_.events[at];
        if (e.kind == EventKind::kPointBecame) {
          add(at, "Its " + name(point_) + " became " + words(static_cast<PointPhase>(e.to)) + " " + reason(e),
              bound_state(at));
        }
        if (e.kind != EventKind::kPointFused || e.other != point_) continue;
        point_ = e.point;
        add(at, "Its " + name(e.other) + " became part of " + name(e.point) + " " + reason(e), bound_state(at));
        after = at;
        another = true;
        break;
      }
    }
  }

  void take(At at) {
    const Event& e = log_.events[at];
    if (ended) add(at, "Another track has its number", "unmapped");
    ended = false;
    if (e.kind == EventKind::kTrackBound) {
      point_ = e.point;
      add(at, "It was bound to " + name(e.point) + " " + reason(e), bound_state(at));
    } else if (e.kind == EventKind::kTrackUnbound) {
      add(at, "It was unbound from " + name(e.point) + " " + reason(e), unbound_state(e.to));
      point_ = PointId();
    } else if (e.kind == EventKind::kTrackBecame) {
      const bool resting = static_cast<TrackMotion>(e.to) == TrackMotion::kResting;
      add(at, (resting ? "It counts as resting again " : "It became " + unbound_state(e.to) + " ") + reason(e),
          unbound_state(e.to));
    } else if (e.kind == EventKind::kTrackMissed) {
      entries.push_back({.t_ns = e.t_ns, .text = miss_sentence("It", e), .fold = "misses", .at = at});
      if (e.why == Why::kOutsideGate) entries.back().sigmas = e.figures[1];
    } else if (e.kind == EventKind::kTrackEnded) {
      begin(at, e);
      add(at, "It ended " + reason(e), "no longer followed");
      point_ = PointId();
      ended = true;
    }
  }

  // The end tells when it began, if something happened at that frame set.
  void begin(At end, const Event& e) {
    if (!(e.figures[0] >= 1) || e.figures[0] > e.set.value + 1.0) return;
    const auto set = static_cast<std::uint32_t>(e.set.value + 1 - static_cast<std::uint32_t>(e.figures[0]));
    const auto first = std::ranges::lower_bound(log_.events, SetId(set), {}, &Event::set);
    if (first == log_.events.end() || first->set != SetId(set)) return;
    const At at = std::min(end, static_cast<At>(first - log_.events.begin()));
    add(at, "Its camera began to follow it", "unmapped");
  }

  const EventLog& log_;
  PointId point_;  // that it is bound to
};

}  // namespace

std::optional<Life> life_of_track(const EventLog& log, const TrackKey& track) {
  if (!log.of_track.contains(track)) return std::nullopt;
  TrackLife life(log, track);
  return Life{.subject = "track " + name(log, track), .entries = std::move(life.entries), .alive = !life.ended};
}

}  // namespace coslam::explain
