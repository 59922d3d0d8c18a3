// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/associate/fuse.h"

#include <Eigen/LU>
#include <algorithm>
#include <optional>
#include <tuple>
#include <unordered_set>
#include <utility>
#include <vector>

#include "server/estimator/associate/patch_match.h"
#include "server/estimator/associate/points_by_place.h"
#include "server/estimator/associate/recall.h"
#include "server/estimator/associate/track_grid.h"
#include "server/estimator/associate/turns.h"
#include "server/estimator/associate/verify.h"

namespace coslam {
namespace {

struct FuseCandidate {
  double d2;
  PointId first, second;  // the second is bound to the track
  CameraId camera;
  const ServerTrack* track;
};

std::vector<FuseCandidate> candidates_of(const Map& map, const MapCamera& camera, const PointsByPlace& points) {
  std::vector<FuseCandidate> out;
  const Rigid3& pose = camera.frames.back().cam_from_world;
  const double gate_px = map.gate_sigma_px(camera), theta = map.config().theta;
  const TrackGrid grid(
      camera,
      [&](const ServerTrack& t) -> std::optional<Eigen::Matrix2d> {
        const MapPoint* p = map.find(t.point);
        if (p == nullptr || !p->rests() || !t.patch || t.gate_failures > 0) return std::nullopt;
        const auto window = search_window(camera.model, pose, *p, gate_px, theta);
        return window ? std::optional(window->covariance) : std::nullopt;
      },
      theta);
  for (const MapPoint* p : points.near_tracks(camera, grid, {theta, gate_px})) {
    if (seen_by(*p, camera.id)) continue;
    const auto window = search_window(camera.model, pose, *p, gate_px, theta);
    if (!window) continue;
    FuseCandidate best{theta * theta, p->id, PointId(), camera.id, nullptr};
    grid.near(window->px, window->radius_px, [&](const TrackGrid::InGrid& t) {
      const Eigen::Matrix2d s = window->covariance + t.covariance + gate_px * gate_px * Eigen::Matrix2d::Identity();
      const Eigen::Vector2d r = t.px - window->px;
      const double d2 = r.dot(s.inverse() * r);
      if (d2 < best.d2) best = {d2, p->id, t.track->point, camera.id, t.track};
    });
    if (best.track != nullptr) out.push_back(best);
  }
  return out;
}

// Seen at once by one camera, now or at a key frame, so they are two things.
bool seen_apart(const MapPoint& p, const MapPoint& q) {
  if (seen_at_once(p, q)) return true;
  auto a = p.key_observations.begin(), b = q.key_observations.begin();
  while (a != p.key_observations.end() && b != q.key_observations.end()) {
    const auto ka = std::tie(a->set, a->camera), kb = std::tie(b->set, b->camera);
    if (ka == kb) return true;
    ka < kb ? ++a : ++b;
  }
  return false;
}

void add_views(const Map& map, const MapPoint& p, double check_back_s, std::vector<View>* views) {
  for (const View& v : map.key_views_of(p)) views->push_back(v);
  for (const BoundTrack& b : p.bound) {
    const MapCamera& c = map.camera(b.camera);
    const std::vector<View> all =
        map.views_of(c, c.tracks.at(b.track), static_cast<std::size_t>(c.frames_in(check_back_s, 2)));
    views->insert(views->end(), all.begin(), all.end());
  }
}

// The one position of both, if it explains all their views.
std::optional<Eigen::Vector3d> joint_position(const Map& map, const MapPoint& p, const MapPoint& q, double sigma_px,
                                              double check_back_s) {
  // Of many views, over the gate of one. Two visits of a place have many views each: what tells them apart by half a
  // gate is another corner, or a place that has drifted, which the adjustment is to mend first.
  constexpr double kWorst = 1.5, kWorstOfVisits = 0.5;
  const bool visits = !map.is_recent(p.last_seen) || !map.is_recent(q.last_seen);
  std::vector<View> views;
  add_views(map, p, check_back_s, &views);
  add_views(map, q, check_back_s, &views);
  const TriangulationResult t = triangulate(views, 1.0, 0.0);
  const PointEstimate one{t.position, Eigen::Matrix3d::Zero()};
  if (t.status != TriangulationStatus::kOk ||
      !explains(one, views, sigma_px, (visits ? kWorstOfVisits : kWorst) * map.config().theta))
    return std::nullopt;
  return t.position;
}

// What a candidate's two points are as one.
struct Joint {
  Eigen::Vector3d position;
  double zncc;
};

// Empty when they are two, as far as that can be told.
std::optional<Joint> as_one(const Map& map, const FuseCandidate& c) {
  const MapPoint *p = map.find(c.first), *q = map.find(c.second);
  if (p == nullptr || q == nullptr || c.track->point != c.second || seen_apart(*p, *q)) return std::nullopt;
  const MapCamera& camera = map.camera(c.camera);
  const auto cut_at = camera.frame_at(c.track->patch_set);
  if (cut_at == nullptr || cut_at->map != p->map) return std::nullopt;
  const auto fit = fit_patch(map, *p, camera, cut_at->cam_from_world, *c.track->patch);
  if (!fit || fit->zncc < map.config().zncc_min || !fit->same_centre) return std::nullopt;
  const auto position = joint_position(map, *p, *q, map.gate_sigma_px(camera), map.config().check_back_s);
  if (!position) return std::nullopt;
  return Joint{*position, fit->zncc};
}

// Of each, as the map is now.
std::vector<std::optional<Joint>> as_one(const Map& map, const std::vector<FuseCandidate>& candidates,
                                         Workers& workers) {
  constexpr std::size_t kPart = 16;
  std::vector<std::optional<Joint>> out(candidates.size());
  workers.each((candidates.size() + kPart - 1) / kPart, [&](std::size_t part) {
    const std::size_t end = std::min(candidates.size(), (part + 1) * kPart);
    for (std::size_t i = part * kPart; i < end; ++i) out[i] = as_one(map, candidates[i]);
  });
  return out;
}

}  // namespace

FuseReport fuse_points(FuseEdit& edit, const FrameSet& set, Workers& workers) {
  const Map& map = edit.map();
  FuseReport report;
  const std::vector<CameraId> cameras = cameras_in_turn(set, map.round(map.config().match_period_s));
  const PointsByPlace points(static_points_around(map, cameras));
  std::vector<std::vector<FuseCandidate>> of_cameras(cameras.size());
  workers.each(of_cameras.size(), [&](std::size_t i) {
    const MapCamera& camera = map.camera(cameras[i]);
    if (camera.frames.back().valid()) of_cameras[i] = candidates_of(map, camera, points);
  });
  std::vector<FuseCandidate> candidates;
  for (const auto& of_camera : of_cameras) candidates.insert(candidates.end(), of_camera.begin(), of_camera.end());
  report.candidates = static_cast<int>(candidates.size());
  std::stable_sort(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) { return a.d2 < b.d2; });
  const std::vector<std::optional<Joint>> joints = as_one(map, candidates, workers);
  std::unordered_set<PointId> changed;  // since then
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const FuseCandidate& c = candidates[i];
    const bool anew = changed.contains(c.first) || changed.contains(c.second);
    const std::optional<Joint> joint = anew ? as_one(map, c) : joints[i];
    if (!joint) continue;
    const auto [kept_id, removed_id] = std::minmax(c.first, c.second);
    edit.fuse(kept_id, removed_id, Why::kOneCorner, {std::sqrt(c.d2), joint->zncc});
    edit.reposition_point(*map.find(kept_id), joint->position);
    changed.insert({kept_id, removed_id});
    ++report.fused;
  }
  return report;
}

}  // namespace coslam
