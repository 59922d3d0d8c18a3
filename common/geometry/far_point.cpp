// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/far_point.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace coslam {

FarPoint far_point(std::span<const View> views, double usual_depth, double sigma_px) {
  constexpr int kIterations = 4;
  constexpr double kLeast = 0.05;  // of the usual inverse depth: infinity, where numbers still are numbers
  const View& first = views.front();
  const Eigen::Vector3d ray = first.camera->normalized_from_pixel(first.undistorted_px).homogeneous();
  const double usual = 1 / usual_depth, prior = 1 / (usual * usual);
  double rho = usual, information = prior;
  std::vector<std::pair<const View*, Rigid3>> later;
  const Rigid3 world_from_first = first.cam_from_world.inverse();
  for (const View& v : views.subspan(1)) later.emplace_back(&v, v.cam_from_world * world_from_first);
  // A view sees the direction ray + rho * (way to its camera); Gauss-Newton in rho alone.
  for (int i = 0; i < kIterations; ++i) {
    information = prior;
    double gradient = prior * (usual - rho);
    for (const auto& [view, from_first] : later) {
      const View& v = *view;
      const Eigen::Vector3d x = from_first.rotation * ray + rho * from_first.translation;
      if (x.z() < 1e-3) continue;
      const Eigen::Matrix2d raw = v.camera->raw_by_undistorted(v.undistorted_px);
      const Eigen::Vector2d j = raw * v.camera->project_jacobian(x) * from_first.translation;
      information += j.squaredNorm() / (sigma_px * sigma_px);
      gradient += j.dot(raw * (v.undistorted_px - v.camera->project(x))) / (sigma_px * sigma_px);
    }
    rho = std::max(rho + gradient / information, kLeast * usual);
  }
  FarPoint out;
  out.inverse_depth = rho;
  out.sigma = 1 / std::sqrt(information);
  const Eigen::Vector3d along = first.cam_from_world.rotation.conjugate() * (ray / rho);
  const double distance = along.norm(), across = sigma_px * distance / first.camera->focal_px();
  const double spread = distance * out.sigma / rho;
  const Eigen::Matrix3d uu = along * along.transpose() / (distance * distance);
  out.position = first.cam_from_world.center() + along;
  out.covariance = spread * spread * uu + across * across * (Eigen::Matrix3d::Identity() - uu);
  return out;
}

}  // namespace coslam
