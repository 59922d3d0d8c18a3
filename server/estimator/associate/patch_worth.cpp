// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/associate/patch_worth.h"

#include <Eigen/LU>
#include <algorithm>

#include "server/estimator/associate/points_by_place.h"
#include "server/estimator/associate/track_grid.h"

namespace coslam {

PatchWorths::PatchWorths(const Map& map, const FrameSet& set) {
  const PointsByPlace points(recent_static_points(map));
  for (const CameraFrame& cf : set.frames) {
    const MapCamera& camera = map.camera(cf.camera);
    if (camera.frames.back().valid()) collect(map, camera, points);
  }
}

PatchWorths::Rank PatchWorths::rank_of(CameraId camera, TrackId track) const {
  const auto at = ranks_.find({camera, track});
  return at == ranks_.end() ? Rank{PatchWorth::kAlone, 0} : at->second;
}

void PatchWorths::note(CameraId camera, TrackId track, const Rank& rank) {
  const auto [at, is_new] = ranks_.try_emplace({camera, track}, rank);
  if (!is_new) at->second = std::min(at->second, rank);
}

void PatchWorths::collect(const Map& map, const MapCamera& camera, const PointsByPlace& points) {
  const Rigid3& pose = camera.frames.back().cam_from_world;
  const double gate_px = map.gate_sigma_px(camera), theta = map.config().theta;
  const TrackGrid grid(
      camera,
      [&](const ServerTrack& t) -> std::optional<Eigen::Matrix2d> {
        if (t.free_and_resting()) return Eigen::Matrix2d::Zero();
        const MapPoint* p = map.find(t.point);
        if (p == nullptr || !p->rests() || t.gate_failures > 0) return std::nullopt;
        const auto window = search_window(camera.model, pose, *p, gate_px, theta);
        return window ? std::optional(window->covariance) : std::nullopt;
      },
      theta);
  for (const MapPoint* p : points.near_tracks(camera, grid, {theta, gate_px})) {
    if (seen_by(*p, camera.id)) continue;
    const auto window = search_window(camera.model, pose, *p, gate_px, theta);
    if (!window) continue;
    std::pair<double, const ServerTrack*> nearest{theta * theta, nullptr};
    grid.near(window->px, window->radius_px, [&](const TrackGrid::InGrid& t) {
      const Eigen::Matrix2d s = window->covariance + gate_px * gate_px * Eigen::Matrix2d::Identity() + t.covariance;
      const Eigen::Vector2d r = t.px - window->px;
      const double d2 = r.dot(s.inverse() * r);
      if (d2 < nearest.first) nearest = {d2, t.track};
    });
    const auto [d2, track] = nearest;
    if (track == nullptr) continue;
    const bool point_has = !p->patches.empty(), track_has = track->patch.has_value();
    if (!track_has) note(camera.id, track->id, {point_has ? PatchWorth::kDecides : PatchWorth::kHelps, d2});
    if (point_has) continue;
    for (const BoundTrack& b : p->bound) {
      note(b.camera, b.track, {track_has ? PatchWorth::kDecides : PatchWorth::kHelps, d2});
    }
  }
}

}  // namespace coslam
