// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/map/maps_pen.h"

#include <algorithm>

namespace coslam {

void MapsPen::note_moved(MapId map, Why why, Figures figures) {
  Event e = event(EventKind::kMapMoved, why, figures);
  e.map = map;
  journal_.note(e);
}

MapId MapsPen::new_map(Why why, double figure) {
  Event e = event(EventKind::kMapStarted, why, {figure, 0});
  e.map = MapId(map_.next_map_++);
  journal_.note(e);
  return e.map;
}

void MapsPen::add_key_frame(SetId set, const std::vector<CameraId>& spared) {
  if (map_.is_key_frame(set)) return;
  const auto at = std::upper_bound(map_.key_frames_.begin(), map_.key_frames_.end(), KeyFrame{set},
                                   [](const KeyFrame& a, const KeyFrame& b) { return a.set < b.set; });
  map_.key_frames_.insert(at, {set});
  for (const CameraId camera : spared) map_.skipped_key_images_.emplace(set, camera);
  for (const MapCamera& c : map_.cameras_) {
    if (!map_.keeps_observations_of(set, c.id)) continue;
    for (const auto& [id, t] : c.tracks) {
      MapPoint* p = mutable_point(t.point);
      if (p == nullptr || set.value < t.distrusted_before || t.gate_failures > 0) continue;
      if (const auto i = t.index_at(set)) observe(*p, {set, c.id, id, t.seen[*i].undistorted_px});
    }
  }
}

void MapsPen::add_key_image(SetId set, CameraId camera) {
  if (!map_.key_images_.emplace(set, camera).second || map_.is_key_frame(set)) return;
  for (const auto& [id, track] : map_.camera(camera).tracks) {
    MapPoint* p = mutable_point(track.point);
    if (p == nullptr || track.seen.back().set != set || track.gate_failures > 0) continue;
    observe(*p, {set, camera, id, track.seen.back().undistorted_px});
  }
}

void MapsPen::move_map(MapId map, const Similarity3& new_from_old) {
  for (const auto& [id, p] : map_.points_.all) {
    if (p.map == map) transform_point(p, new_from_old);
  }
  for (MapCamera& c : map_.cameras_) {
    for (FramePose& f : c.frames) {
      if (f.map == map) f.cam_from_world = transform_world(f.cam_from_world, new_from_old);
    }
    if (c.map != map) continue;
    carry_agent(c, new_from_old);
  }
  raise_epoch();
}

void MapsPen::transform(MapId map, const Similarity3& new_from_old, Why why) {
  move_map(map, new_from_old);
  map_.moves_.push_back({map, map, new_from_old});
  note_moved(map, why, {new_from_old.scale, 0});
}

void MapsPen::merge(MapId from, MapId into, const Similarity3& into_from_from) {
  move_map(from, into_from_from);
  map_.moves_.push_back({from, into, into_from_from});
  for (auto& [id, p] : map_.points_.all) {
    if (p.map == from) p.map = into;
  }
  for (MapCamera& c : map_.cameras_) {
    for (FramePose& f : c.frames) {
      if (f.map == from) f.map = into;
    }
    if (const auto past = c.past.placed.extract(from)) c.past.placed[into] += past.mapped();
    if (c.map != from) continue;
    c.map = into;
    if (c.merged_from == MapId()) c.merged_from = from;
  }
  Event e = event(EventKind::kMapMerged, Why::kMapsMet, {into_from_from.scale, 0});
  e.map = into;
  e.from = from;
  journal_.note(e);
}

}  // namespace coslam
