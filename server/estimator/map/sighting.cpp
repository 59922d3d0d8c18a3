// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/map/sighting.h"

#include <algorithm>

namespace coslam {

int cameras_of(const std::vector<Seen>& seen) {
  std::vector<CameraId> cameras;
  for (const Seen& s : seen) {
    if (std::find(cameras.begin(), cameras.end(), s.track.camera) == cameras.end()) cameras.push_back(s.track.camera);
  }
  return static_cast<int>(cameras.size());
}

double gate_px_of(const Map& map, const std::vector<Seen>& seen) {
  double gate_px = 0;
  for (const Seen& s : seen) gate_px = std::max(gate_px, map.gate_sigma_px(map.camera(s.track.camera)));
  return map.config().theta * gate_px;
}

Sighting sighting(const MapCamera& camera, const ServerTrack& track, std::size_t i) {
  Sighting out{camera.id, track.seen[i].undistorted_px + track.offset_px};
  const FramePose* f = camera.frame_at(track.seen[i].set);
  const FramePose* before = i == 0 ? nullptr : camera.frame_at(track.seen[i - 1].set);
  if (before != nullptr && before + 1 == f) {
    out.step_px = track.seen[i].undistorted_px - track.seen[i - 1].undistorted_px;
  }
  return out;
}

std::optional<View> view_at(const MapCamera& camera, const ServerTrack& track, std::size_t i, TimeNs t_ns) {
  return camera.view_at(camera.map, track.seen[i].set, sighting(camera, track, i), t_ns);
}

std::vector<Seen> seen_now(const Map& map, const MapPoint& p) {
  std::vector<Seen> out;
  for (const BoundTrack& b : p.bound) {
    const MapCamera& c = map.camera(b.camera);
    const ServerTrack& t = c.tracks.at(b.track);
    if (c.map != p.map || t.seen.back().set != map.now()) continue;
    if (const auto view = view_at(c, t, t.seen.size() - 1, map.now_ns())) out.push_back({b, *view});
  }
  return out;
}

std::optional<TriangulationResult> position_of(const Map& map, const std::vector<Seen>& seen, double min_parallax_rad) {
  if (cameras_of(seen) < 2) return std::nullopt;
  std::vector<View> views;
  double sigma_px = 0;
  for (const Seen& s : seen) {
    views.push_back(s.view);
    sigma_px = std::max(sigma_px, map.covariance_sigma_px(map.camera(s.track.camera)));
  }
  const TriangulationResult t = triangulate(views, sigma_px, min_parallax_rad);
  if (t.status != TriangulationStatus::kOk || t.max_error_px > gate_px_of(map, seen)) return std::nullopt;
  return t;
}

std::optional<FarPoint> far_point_of(const Map& map, const MapCamera& camera, const ServerTrack& track) {
  if (camera.scene_depth <= 0 || !track.free_and_resting()) return std::nullopt;
  if (static_cast<int>(track.seen.size()) < camera.frames_in(kSettled_s, kLeastFrames)) return std::nullopt;
  const std::vector<View> views = map.views_of(camera, track, kViewsOfTrack);
  if (views.empty()) return std::nullopt;
  return far_point(views, camera.scene_depth, map.covariance_sigma_px(camera));
}

std::optional<MotionPosition> position_of(const Map& map, MapId in, const MotionSample& sample) {
  std::vector<View> views;
  double sigma_px = 0;
  for (const Sighting& seen : sample.seen) {
    const MapCamera& c = map.camera(seen.camera);
    const auto view = c.view_at(in, sample.set, seen, sample.t_ns);
    if (!view) continue;
    views.push_back(*view);
    sigma_px = std::max(sigma_px, map.covariance_sigma_px(c));
  }
  const TriangulationResult t = triangulate(views, sigma_px, 0.0);
  if (t.status != TriangulationStatus::kOk) return std::nullopt;
  return MotionPosition{t, static_cast<int>(views.size())};
}

}  // namespace coslam
