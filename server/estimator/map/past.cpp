// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/map/past.h"

#include <algorithm>
#include <map>

#include "server/estimator/map/edit.h"

namespace coslam {
namespace {

// How the world of a camera changed at a frame that memory still has, beside what the map as a whole went through:
// old_from_new on the right of cam_from_world.
struct Change {
  SetId set;
  Rigid3 old_from_new;
};

Rigid3 carried(const FramePose& frame, const std::vector<Change>& changes) {
  const auto after = std::ranges::lower_bound(changes, frame.set, {}, &Change::set);
  if (after == changes.end()) return frame.cam_from_world * changes.back().old_from_new;
  Rigid3 by_after = frame.cam_from_world * after->old_from_new;
  if (after == changes.begin() || after->set == frame.set) return by_after;
  const Change& before = *(after - 1);
  const double s = static_cast<double>(frame.set.value - before.set.value) / (after->set.value - before.set.value);
  return interpolate(frame.cam_from_world * before.old_from_new, by_after, s);
}

void renumber(const Renumbered& renumbered, ArchivedPlace* put) {
  put->moves += renumbered.moves;
  put->shifted_ns += renumbered.shifted_ns;
}

// Times of the past stay as they were put down.
Renumbered without_time(Renumbered renumbered) {
  renumbered.later_ns = 0;
  return renumbered;
}

}  // namespace

void renumber(const Renumbered& renumbered, PastFrames* block) {
  const Renumbered numbers = without_time(renumbered);
  renumber(renumbered, &block->put);
  Renumber(numbers).apply(block->camera);
  Renumber(numbers).apply(block->frames);
}

void renumber(const Renumbered& renumbered, PastPlaces* block) {
  const Renumbered numbers = without_time(renumbered);
  renumber(renumbered, &block->put);
  Renumber(numbers).apply(block->places);
}

MovedMap moved_map(const Map& map, const ArchivedPlace& put, MapId earlier_map) {
  MovedMap out{earlier_map, {}};
  const auto& moves = map.moves();
  for (std::size_t i = put.moves; i < moves.size(); ++i) {
    if (moves[i].from != out.map) continue;
    out.map = moves[i].into;
    out.now_from_then = moves[i].into_from_from * out.now_from_then;
  }
  return out;
}

std::vector<FramePose> frames_now(const Map& map, const PastFrames& block) {
  const MapCamera& camera = map.camera(block.camera);
  std::map<MapId, MovedMap> moved;
  std::vector<FramePose> out = block.frames;
  std::map<MapId, std::vector<Change>> changes;  // by the map that it is now
  for (FramePose& f : out) {
    f.capture_ns += map.shifted_ns() - block.put.shifted_ns;
    if (!f.valid()) continue;
    const auto [at, added] = moved.try_emplace(f.map);
    if (added) at->second = moved_map(map, block.put, f.map);
    f.map = at->second.map;
    f.cam_from_world = transform_world(f.cam_from_world, at->second.now_from_then);
    const FramePose* now = camera.frame_at(f.set);
    if (now != nullptr && now->map == f.map) {
      changes[f.map].push_back({f.set, f.cam_from_world.inverse() * now->cam_from_world});
    }
  }
  for (FramePose& f : out) {
    const auto at = changes.find(f.map);
    if (f.valid() && at != changes.end()) f.cam_from_world = carried(f, at->second);
  }
  return out;
}

}  // namespace coslam
