// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/simulation/view_overlap.h"

#include <algorithm>
#include <cmath>

namespace coslam::sim {
namespace {

using Eigen::Vector3d;

constexpr int kColumns = 20, kRows = 15;

std::vector<Vector3d> grid_rays(const CameraModel& camera) {
  std::vector<Vector3d> out;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const auto undistorted_px = camera.undistorted_from_raw(
          {(column + 0.5) * camera.width_px / kColumns - 0.5, (row + 0.5) * camera.height_px / kRows - 0.5});
      if (undistorted_px) out.emplace_back(camera.normalized_from_pixel(*undistorted_px).homogeneous());
    }
  }
  return out;
}

}  // namespace

ViewOverlap::ViewOverlap(const Scene& scene) : scene_(scene) {
  for (int i = 0; i < scene.cameras(); ++i) rays_.push_back(grid_rays(scene.camera(i)));
}

bool ViewOverlap::seen_by(int camera, const Rigid3& cam_from_world, const Vector3d& point, const Vector3d& other_way,
                          double t_s) const {
  constexpr double kNearM = 0.1, kWidest = 1.3;  // tangent, beyond any lens: distortion models fold back there
  constexpr double kMinCosine = 0.7071, kMaxRatio = 2.5;
  constexpr double kToleranceM = 0.02, kTolerance = 0.005;
  const Vector3d in_cam = cam_from_world * point;
  if (in_cam.z() < kNearM || in_cam.head<2>().norm() > kWidest * in_cam.z()) return false;
  const CameraModel& model = scene_.camera(camera);
  if (!model.contains_raw(model.raw_from_undistorted(model.project(in_cam)))) return false;
  const Vector3d eye = cam_from_world.center(), way = point - eye;
  const double distance_m = way.norm(), other_m = other_way.norm();
  if (way.dot(other_way) < kMinCosine * distance_m * other_m) return false;
  if (std::max(distance_m, other_m) > kMaxRatio * std::min(distance_m, other_m)) return false;
  const auto hit = scene_.cast(eye, way.normalized(), t_s);
  return !hit || hit->distance_m > distance_m * (1 - kTolerance) - kToleranceM;
}

Eigen::MatrixXd ViewOverlap::at(double t_s) const {
  const int n = scene_.cameras();
  std::vector<Rigid3> cam_from_world;
  cam_from_world.reserve(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) cam_from_world.push_back(scene_.cam_from_world(i, t_s));
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(n, n);
  for (int a = 0; a < n; ++a) {
    const auto& pose = cam_from_world[static_cast<std::size_t>(a)];
    const auto& rays = rays_[static_cast<std::size_t>(a)];
    const Eigen::Matrix3d world_from_cam = pose.rotation.conjugate().toRotationMatrix();
    for (const Vector3d& ray : rays) {
      const auto hit = scene_.cast(pose.center(), world_from_cam * ray, t_s);
      if (!hit) continue;
      for (int b = 0; b < n; ++b) {
        if (b == a ||
            seen_by(b, cam_from_world[static_cast<std::size_t>(b)], hit->point, hit->point - pose.center(), t_s))
          out(a, b) += 1;
      }
    }
    out.row(a) /= static_cast<double>(rays.size());
  }
  return out;
}

}  // namespace coslam::sim
