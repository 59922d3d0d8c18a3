// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/associate/pair_match.h"

#include <Eigen/LU>

namespace coslam {
namespace {

Eigen::Matrix3d intrinsics_inverse(const CameraModel& c) {
  Eigen::Matrix3d k;
  k << 1 / c.fx, 0, -c.cx / c.fx, 0, 1 / c.fy, -c.cy / c.fy, 0, 0, 1;
  return k;
}

std::vector<Seed> shared_points(const Map& map, CameraId first, CameraId second) {
  std::vector<Seed> seeds;
  const MapCamera& other = map.camera(second);
  for (const auto& [id, t] : map.camera(first).tracks) {
    const MapPoint* p = map.find(t.point);
    if (p == nullptr) continue;
    for (const BoundTrack& bound : p->bound) {
      if (bound.camera != second) continue;
      const Eigen::Vector2d first_px = t.seen.back().undistorted_px.cast<double>(),
                            second_px = other.tracks.at(bound.track).seen.back().undistorted_px.cast<double>();
      seeds.push_back({first_px, second_px - first_px});
    }
  }
  return seeds;
}

}  // namespace

PairView make_pair_view(const Map& map, const ViewEdge& edge, const Rigid3& first_pose, const Rigid3& second_pose) {
  PairView v{&map.camera(edge.first), &map.camera(edge.second)};
  v.first_pose = first_pose;
  v.second_pose = second_pose;
  const Rigid3 second_from_first = v.second_pose * v.first_pose.inverse();
  const Eigen::Matrix3d essential = skew(second_from_first.translation) * second_from_first.rotation.toRotationMatrix();
  v.fundamental = intrinsics_inverse(v.second->model).transpose() * essential * intrinsics_inverse(v.first->model);
  v.seeds = shared_points(map, edge.first, edge.second);
  return v;
}

bool has_pose_now(const CameraFrames& c, const FrameSet& set) {
  return !c.frames.empty() && c.frames.back().set == set.id && c.frames.back().valid();
}

double band_px_of(const Map& map, const PairView& view) {
  return map.gate_sigma_px(*view.first) + map.gate_sigma_px(*view.second);
}

std::optional<Eigen::Vector2d> expected_disparity(const PairView& view, const Eigen::Vector2d& px, double radius_px) {
  const Seed* best = nullptr;
  double least = radius_px * radius_px;
  for (const Seed& s : view.seeds) {
    const double d2 = (s.in_first - px).squaredNorm();
    if (d2 < least) {
      least = d2;
      best = &s;
    }
  }
  return best == nullptr ? std::nullopt : std::optional(best->disparity);
}

}  // namespace coslam
