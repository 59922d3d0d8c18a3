// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/pose/own_map.h"

#include <algorithm>
#include <cmath>

namespace coslam {
namespace {

constexpr std::size_t kMostSights = 8;
constexpr double kTurn_rad = 0.005;  // of the ray, by which one more sight tells something
constexpr double kLeastParallax_rad = 0.02;
constexpr double kSigma_px = 1.0;      // drift of the track and errors of the poses, at 640 px image width
constexpr double kMostError_px = 3.0;  // likewise

// Every other one goes, but for the first and the newest.
void thin(auto& sights) {
  std::size_t size = 0;
  for (std::size_t i = 0; i < sights.size(); ++i) {
    if (i % 2 == 0 || i + 1 == sights.size()) sights[size++] = sights[i];
  }
  sights.resize(size);
}

}  // namespace

void OwnMap::observe(const Rigid3& cam_from_world, const std::vector<TrackObservation>& tracks) {
  auto at = seen_.begin();
  for (const TrackObservation& o : tracks) {
    while (at != seen_.end() && at->first < o.track) at = seen_.erase(at);
    const Eigen::Vector2d px = o.undistorted_px.cast<double>();
    const Eigen::Vector3d ray = world_ray({&camera_, cam_from_world, px});
    const bool known = at != seen_.end() && at->first == o.track;
    if (!known) at = seen_.emplace_hint(at, o.track, Seen{});
    Seen& seen = at->second;
    ++at;
    if (known && seen.ray.dot(ray) > std::cos(kTurn_rad)) continue;
    seen.ray = ray;
    seen.sights.push_back({cam_from_world, px});
    if (seen.sights.size() > kMostSights) thin(seen.sights);
  }
  seen_.erase(at, seen_.end());
}

std::optional<OwnMap::Point> OwnMap::find(TrackId track) const {
  const auto at = seen_.find(track);
  if (at == seen_.end()) return std::nullopt;
  std::vector<View> views;
  for (const Sight& s : at->second.sights) views.push_back({&camera_, s.cam_from_world, s.undistorted_px});
  const double scale = camera_.width_px / 640.0;
  const TriangulationResult t = triangulate(views, kSigma_px * scale, kLeastParallax_rad);
  if (t.status != TriangulationStatus::kOk || t.max_error_px > kMostError_px * scale) return std::nullopt;
  return Point{t.position, t.covariance};
}

void OwnMap::move(const Similarity3& new_from_old) {
  for (auto& [track, seen] : seen_) {
    for (Sight& s : seen.sights) s.cam_from_world = transform_world(s.cam_from_world, new_from_old);
    seen.ray = new_from_old.rotation * seen.ray;
  }
}

}  // namespace coslam
