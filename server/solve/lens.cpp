// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/solve/lens.h"

#include <Eigen/Geometry>
#include <cmath>

namespace coslam {

Eigen::Vector2d LensChange::project(const CameraModel& camera, const Eigen::Vector3d& in_cam) const {
  const Eigen::Vector2d n = in_cam.hnormalized();
  const double r2 = n.squaredNorm(), g = std::exp(values[0]) * (1 + r2 * (values[3] + r2 * values[4]));
  return {camera.cx + values[1] + camera.fx * g * n.x(), camera.cy + values[2] + camera.fy * g * n.y()};
}

std::array<double, 5> nominal_lens_sigma(const CameraModel& camera) {
  constexpr double kFocal = 0.05, kCentre = 0.02, kRadial = 0.05;
  return {kFocal, kCentre * camera.width_px, kCentre * camera.width_px, kRadial, kRadial};
}

}  // namespace coslam
