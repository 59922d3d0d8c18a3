// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/associate/register.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "server/estimator/associate/patch_match.h"
#include "server/estimator/associate/points_by_place.h"
#include "server/estimator/associate/recall.h"
#include "server/estimator/associate/track_grid.h"
#include "server/estimator/associate/turns.h"
#include "server/estimator/map/sighting.h"

namespace coslam {
namespace {

struct Candidate {
  double d2;
  const MapPoint* point;
  const ServerTrack* track;
};

// What one camera's free tracks may show, of the points of a set.
struct Candidates {
  std::optional<TrackGrid> grid;    // empty: the camera has no pose
  std::vector<Candidate> by_point;  // ascending
};

// The track that is nearest to where the point should be, if one is near enough.
std::optional<Candidate> candidate_of(const Map& map, const MapCamera& camera, const TrackGrid& grid,
                                      const MapPoint& p) {
  const Rigid3& pose = camera.frames.back().cam_from_world;
  const double gate_px = map.gate_sigma_px(camera), theta = map.config().theta;
  if (seen_by(p, camera.id)) return std::nullopt;
  const auto window = search_window(camera.model, pose, p, gate_px, theta);
  if (!window) return std::nullopt;
  Candidate best{theta * theta, nullptr, nullptr};
  grid.near(window->px, window->radius_px, [&](const TrackGrid::InGrid& t) {
    const auto d2 = gate_distance2({p.position, p.covariance}, camera.model, pose, t.px, gate_px);
    if (d2 && *d2 < best.d2) best = {*d2, &p, t.track};
  });
  return best.track != nullptr ? std::optional(best) : std::nullopt;
}

Candidates collect(const Map& map, const MapCamera& camera, const PointsByPlace& points) {
  Candidates out;
  if (!camera.frames.back().valid()) return out;
  out.grid.emplace(camera, [](const ServerTrack& t) { return t.free_and_resting() && t.patch; });
  for (const MapPoint* p : points.near_tracks(camera, *out.grid, {map.config().theta, map.gate_sigma_px(camera)})) {
    if (const auto candidate = candidate_of(map, camera, *out.grid, *p)) out.by_point.push_back(*candidate);
  }
  return out;
}

// Points were moved since they were collected.
void look_again(const Map& map, const MapCamera& camera, const std::set<PointId>& moved, Candidates* candidates) {
  std::vector<Candidate>& all = candidates->by_point;
  std::erase_if(all, [&](const Candidate& c) { return moved.contains(c.point->id); });
  for (const PointId id : moved) {
    const MapPoint* p = map.find(id);
    if (p == nullptr || p->map != camera.map) continue;
    const auto candidate = candidate_of(map, camera, *candidates->grid, *p);
    if (candidate)
      all.insert(std::ranges::upper_bound(all, id, {}, [](const auto& c) { return c.point->id; }), *candidate);
  }
}

}  // namespace

std::optional<PointEstimate> triangulated_anew(const Map& map, const MapPoint& point) {
  std::vector<View> views = map.key_views_of(point);
  for (const BoundTrack& b : point.bound) {
    const MapCamera& c = map.camera(b.camera);
    const ServerTrack& t = c.tracks.at(b.track);
    const FramePose* f = c.frame_at(t.seen.back().set);
    if (t.gate_failures > 0 || f == nullptr || f->map != point.map) continue;
    views.push_back({&c.model, f->cam_from_world, t.seen.back().undistorted_px.cast<double>()});
  }
  const TriangulationResult t = triangulate(views, 1.0, kLeastParallax_rad);
  if (t.status != TriangulationStatus::kOk) return std::nullopt;
  return PointEstimate{t.position, map.covariance_of(point, t.position)};
}

bool retriangulate(PointPositionEdit& edit, const MapPoint& point) {
  const auto anew = triangulated_anew(edit.map(), point);
  if (anew) edit.move_point(point, anew->position, anew->covariance);
  return anew.has_value();
}

RegisterReport register_tracks(RegisterEdit& edit, const FrameSet& set, Workers& workers) {
  const Map& map = edit.map();
  RegisterReport report;
  const bool recall_too = map.every(map.config().match_period_s);
  // Rounds of both kinds, each counted by itself.
  const std::uint32_t round = map.round(map.config().match_period_s);
  const std::vector<CameraId> cameras = cameras_in_turn(set, recall_too ? round : map.now().value - round);
  const PointsByPlace points(recall_too ? static_points_around(map, cameras) : recent_static_points(map));
  std::vector<Candidates> of_cameras(cameras.size());
  workers.each(of_cameras.size(), [&](std::size_t i) { of_cameras[i] = collect(map, map.camera(cameras[i]), points); });
  std::set<PointId> moved;
  for (std::size_t i = 0; i < of_cameras.size(); ++i) {
    if (!of_cameras[i].grid) continue;
    const MapCamera& camera = map.camera(cameras[i]);
    look_again(map, camera, moved, &of_cameras[i]);
    std::vector<Candidate>& candidates = of_cameras[i].by_point;
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
      moved.insert(c.point->id);
      ++report.registered;
    }
  }
  return report;
}

}  // namespace coslam
