// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/motion/rest_hypothesis.h"

#include <algorithm>

namespace coslam {
namespace {

constexpr double kBehind_px = 1e9;

// Largest miss of the best static explanation of a track's newest views, near or infinitely far; pixels.
double static_miss_px(const std::vector<View>& views) {
  const TriangulationResult t = triangulate(views, 1.0, 0.0);
  return std::min(t.status == TriangulationStatus::kOk ? t.max_error_px : kBehind_px, far_miss_px(views));
}

// How far the newer view is from where a thing that stood still may appear: on the epipolar line of the older view,
// between infinitely far and `nearest` from the camera.
double epipolar_miss_px(const View& now, const View& older, double nearest) {
  const Eigen::Vector3d ray = world_ray(older);
  Eigen::Vector2d near_px;
  const Eigen::Vector3d far_in_cam = now.cam_from_world.rotation * ray;
  if (far_in_cam.z() <= 0) return 0;
  const Eigen::Vector2d far_px = now.camera->project(far_in_cam);
  const Eigen::Vector3d near_point = older.cam_from_world.center() + nearest * ray;
  if (!project_world(*now.camera, now.cam_from_world, near_point, &near_px)) return 0;
  const Eigen::Vector2d along = near_px - far_px, off = now.undistorted_px - far_px;
  const double share = along.squaredNorm() > 0 ? std::clamp(off.dot(along) / along.squaredNorm(), 0.0, 1.0) : 0.0;
  return (off - share * along).norm();
}

}  // namespace

double far_miss_px(std::span<const View> views) {
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  for (const View& v : views) direction += world_ray(v);
  double far_px = 0;
  for (const View& v : views) {
    const Eigen::Vector3d in_cam = v.cam_from_world.rotation * direction;
    if (in_cam.z() <= 0) return kBehind_px;
    far_px = std::max(far_px, (v.camera->project(in_cam) - v.undistorted_px).norm());
  }
  return far_px;
}

bool moves_by_more(const std::vector<View>& views, std::size_t frames, double nearest, double most_px) {
  std::vector<View> chosen;
  const std::size_t last = std::min(frames, views.size() - 1), step = std::max<std::size_t>(1, (last + 4) / 5);
  for (std::size_t i = 0; i < last; i += step) chosen.push_back(views[i]);
  chosen.push_back(views[last]);
  for (std::size_t i = 1; i < chosen.size(); ++i) {
    if (epipolar_miss_px(chosen[0], chosen[i], nearest) > most_px) return true;
  }
  return static_miss_px(chosen) > most_px;
}

}  // namespace coslam
