// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/map/pen.h"

#include <algorithm>
#include <cstdint>
#include <tuple>

namespace coslam {
namespace {

auto key_of(const KeyObservation& o) { return std::tie(o.set, o.camera, o.track); }

}  // namespace

Event MapPen::event(EventKind kind, Why why, Figures figures) const {
  return {.set = map_.now_, .t_ns = map_.now_ns_, .kind = kind, .why = why, .figures = figures};
}

void MapPen::note_point(EventKind kind, const MapPoint& point, Why why, Figures figures) {
  Event e = event(kind, why, figures);
  e.map = point.map;
  e.point = point.id;
  e.to = static_cast<std::uint8_t>(point.phase);
  journal_.note(e);
}

void MapPen::note_track(EventKind kind, CameraId camera, const ServerTrack& track, Why why, Figures figures) {
  Event e = event(kind, why, figures);
  e.camera = camera;
  e.map = map_.camera(camera).map;
  e.track = track.id;
  e.point = track.point;
  e.to = static_cast<std::uint8_t>(track.motion);
  journal_.note(e);
}

void MapPen::note_camera(EventKind kind, const MapCamera& camera, Why why, Figures figures) {
  Event e = event(kind, why, figures);
  e.camera = camera.id;
  e.map = camera.map;
  journal_.note(e);
}

void MapPen::touch(MapPoint& point) {
  point.last_seen = map_.now_;
  map_.points_.recent.emplace(point.id, &point);
}

// A track may come back to a point, or its point be fused with one that it was bound to before: each observation once.
void MapPen::observe(MapPoint& point, const KeyObservation& seen) {
  auto& all = point.key_observations;
  const auto at = std::lower_bound(all.begin(), all.end(), seen,
                                   [](const auto& a, const auto& b) { return key_of(a) < key_of(b); });
  if (at == all.end() || key_of(*at) != key_of(seen)) all.insert(at, seen);
  map_.observed_in_[{seen.set, seen.camera}].push_back(point.id);
}

}  // namespace coslam
