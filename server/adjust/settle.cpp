// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/adjust/settle.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "common/geometry/pose_refinement.h"

namespace coslam {
namespace {

constexpr int kLeastPoints = 12;
constexpr double kLeastAgree = 0.6;  // of the points
// Squared distance of the old pose in standard deviations of the new one, six degrees of freedom: a hundredth of a
// percent of right poses is so far off, were the old one as uncertain.
constexpr double kFarOff2 = 55;

// Which point each track of one camera showed: the one that it was last seen at.
using PointOfTrack = std::unordered_map<TrackId, const MapPoint*>;

std::vector<PointOfTrack> points_of_tracks(const Map& map, MapId of) {
  std::vector<PointOfTrack> out(map.cameras().size());
  std::vector<std::unordered_map<TrackId, SetId>> last(out.size());
  for (const auto& [id, p] : map.points()) {
    if (p.map != of || !p.proven()) continue;
    for (const KeyObservation& o : p.key_observations) {
      SetId& seen = last[o.camera.value][o.track];
      if (seen > o.set) continue;
      seen = o.set;
      out[o.camera.value][o.track] = &p;
    }
  }
  return out;
}

std::optional<PoseResult> solve(const Map& map, const MapCamera& camera, const PointOfTrack& points,
                                const FramePose& frame, const Rigid3& initial) {
  std::vector<PointObservation> seen;
  for (const HeldTrack& held : frame.held) {
    const auto at = points.find(held.track);
    if (at == points.end()) continue;
    seen.push_back({at->second->position, at->second->covariance, held.undistorted_px.cast<double>()});
  }
  if (std::ssize(seen) < kLeastPoints) return std::nullopt;
  PoseResult result = refine_pose(camera.model, seen, initial, {.sigma_px = map.sigma_bound_px(camera)});
  const bool good = result.status == PoseStatus::kOk && result.inliers >= kLeastPoints &&
                    result.inliers >= kLeastAgree * static_cast<double>(seen.size());
  return good ? std::optional(std::move(result)) : std::nullopt;
}

// Where a frame should be by the two beside it on one side, of which the first is the nearer.
Rigid3 predicted(const FramePose& beside, const FramePose* behind) {
  if (behind == nullptr || behind->map != beside.map) return beside.cam_from_world;
  return beside.cam_from_world * behind->cam_from_world.inverse() * beside.cam_from_world;
}

// One frame after the other from one that has a pose on, as far as the tracks lead. step: 1 forward, -1 backward.
int place_beside(MapEdit& edit, const MapCamera& camera, const PointOfTrack& points, MapId of, int step) {
  const auto n = static_cast<int>(camera.frames.size());
  const auto frame = [&](int i) { return i < 0 || i >= n ? nullptr : &camera.frames[static_cast<std::size_t>(i)]; };
  int placed = 0;
  for (int k = 1; k < n; ++k) {
    const int i = step > 0 ? k : n - 1 - k;
    const FramePose *here = frame(i), *beside = frame(i - step);
    if (here->valid() || beside->map != of) continue;
    const auto result = solve(edit.map(), camera, points, *here, predicted(*beside, frame(i - 2 * step)));
    if (!result) continue;
    edit.place_past(camera, *here, of, result->cam_from_world);
    ++placed;
  }
  return placed;
}

}  // namespace

SettleReport settle_frames(MapEdit& edit, MapId of) {
  SettleReport report;
  const Map& map = edit.map();
  const std::vector<PointOfTrack> points = points_of_tracks(map, of);
  for (const MapCamera& camera : map.cameras()) {
    const PointOfTrack& known = points[camera.id.value];
    for (const FramePose& frame : camera.frames) {
      if (frame.map != of) continue;
      const auto result = solve(map, camera, known, frame, frame.cam_from_world);
      if (!result) continue;
      ++report.solved;
      const Vector6d off = local(frame.cam_from_world, result->cam_from_world);
      if (off.dot(result->covariance.ldlt().solve(off)) < kFarOff2) continue;
      edit.place_past(camera, frame, of, result->cam_from_world);
      ++report.changed;
    }
    for (const int step : {1, -1}) report.placed += place_beside(edit, camera, known, of, step);
  }
  return report;
}

}  // namespace coslam
