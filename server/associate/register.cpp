// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/associate/register.h"

#include <algorithm>
#include <cmath>

#include "server/associate/gate.h"
#include "server/associate/patch_match.h"
#include "server/associate/points_by_place.h"
#include "server/associate/recall.h"
#include "server/associate/track_grid.h"

namespace coslam {
namespace {

struct Candidate {
  double d2;
  const MapPoint* point;
  const ServerTrack* track;
};

void collect(const Map& map, const MapCamera& camera, const PointsByPlace& points, std::vector<Candidate>* out) {
  const TrackGrid grid(camera, [](const ServerTrack& t) { return t.free_and_resting() && t.patch; });
  const Rigid3& pose = camera.frames.back().cam_from_world;
  const double gate_px = map.gate_sigma_px(camera), theta = map.config().theta;
  for (const MapPoint* p : points.near_tracks(camera, grid, {theta, gate_px})) {
    if (seen_by(*p, camera.id)) continue;
    const auto window = search_window(camera.model, pose, *p, gate_px, theta);
    if (!window) continue;
    Candidate best{theta * theta, nullptr, nullptr};
    grid.near(window->px, window->radius_px, [&](const TrackGrid::InGrid& t) {
      const auto d2 = gate_distance2({p->position, p->covariance}, camera.model, pose, t.px, gate_px);
      if (d2 && *d2 < best.d2) best = {*d2, p, t.track};
    });
    if (best.track != nullptr) out->push_back(best);
  }
}

}  // namespace

bool retriangulate(MapEdit& edit, const MapPoint& point) {
  const Map& map = edit.map();
  std::vector<View> views = map.key_views_of(point);
  for (const BoundTrack& b : point.bound) {
    const MapCamera& c = map.camera(b.camera);
    const ServerTrack& t = c.tracks.at(b.track);
    const FramePose* f = c.frame_at(t.seen.back().set);
    if (t.gate_failures > 0 || f == nullptr || f->map != point.map) continue;
    views.push_back({&c.model, f->cam_from_world, t.seen.back().undistorted_px.cast<double>()});
  }
  const TriangulationResult t = triangulate(views, 1.0, 0.01);
  if (t.status != TriangulationStatus::kOk) return false;
  edit.move_point(point, t.position);
  return true;
}

RegisterReport register_tracks(MapEdit& edit, const FrameSet& set) {
  const Map& map = edit.map();
  RegisterReport report;
  const bool look_back = map.every(map.config().match_period_s);
  PointsByPlace points(look_back ? static_points_around(map, set) : recent_static_points(map));
  for (const CameraFrame& cf : set.frames) {
    const MapCamera& camera = map.camera(cf.camera);
    if (!camera.frames.back().valid()) continue;
    std::vector<Candidate> candidates;
    collect(map, camera, points, &candidates);
    std::stable_sort(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) { return a.d2 < b.d2; });
    for (const Candidate& c : candidates) {
      ++report.candidates;
      if (c.track->bound()) continue;
      const FramePose* cut_at = camera.frame_at(c.track->patch_set);
      if (cut_at == nullptr || cut_at->map != c.point->map) continue;
      const auto fit = fit_patch(map, *c.point, camera, cut_at->cam_from_world, *c.track->patch);
      if (!fit || fit->zncc < map.config().zncc_min || !fit->same_centre) continue;
      if (!explains_past(map, camera, *c.track, {c.point->position, c.point->covariance})) continue;
      edit.bind(*c.point, camera.id, *c.track, Why::kRegistered, {std::sqrt(c.d2), fit->zncc});
      edit.keep_recent(*c.point);
      retriangulate(edit, *c.point);
      points.moved(*c.point);
      ++report.registered;
    }
  }
  return report;
}

}  // namespace coslam
