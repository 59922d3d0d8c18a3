// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/solve/lens.h"

#include <Eigen/Geometry>
#include <cmath>

namespace coslam {
namespace {
double magnification(const LensChange& lens, double r2) {
  return std::exp(lens.log_focal()) * (1 + r2 * (lens.values[3] + r2 * lens.values[4]));
}
}  // namespace

Eigen::Vector2d LensChange::project(const CameraModel& camera, const Eigen::Vector3d& in_cam) const {
  const Eigen::Vector2d n = in_cam.hnormalized();
  const double g = magnification(*this, n.squaredNorm());
  return {camera.cx + values[1] + camera.fx * g * n.x(), camera.cy + values[2] + camera.fy * g * n.y()};
}

Eigen::Vector2d LensChange::undone(const CameraModel& camera, const Eigen::Vector2d& px) const {
  if (values == LensChange().values) return px;
  constexpr int kRounds = 10;  // each leaves a tenth or less, as the change is small
  const Eigen::Vector2d seen = camera.normalized_from_pixel(px - centre_px());
  Eigen::Vector2d n = seen;
  for (int i = 0; i < kRounds; ++i) n = seen / magnification(*this, n.squaredNorm());
  return camera.pixel_from_normalized(n);
}

std::array<double, 5> nominal_lens_sigma(const CameraModel& camera) {
  constexpr double kFocal = 0.05, kCentre = 0.02, kRadial = 0.05;
  return {kFocal, kCentre * camera.width_px, kCentre * camera.width_px, kRadial, kRadial};
}

}  // namespace coslam
