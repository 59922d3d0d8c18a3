// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/lens_correction.h"

#include <cmath>

namespace coslam {
namespace {

Eigen::Vector2d focal_of(const CameraModel& camera, const LensCorrection& lens) {
  const double half = 0.5 * lens.log_aspect();
  return {camera.fx * std::exp(lens.log_focal() - half), camera.fy * std::exp(lens.log_focal() + half)};
}

// r of r (1 + k1 r^2 + k2 r^4) = seen; empty beyond the fold.
std::optional<double> radius_of(const LensCorrection& lens, double seen) {
  constexpr int kRounds = 20;
  constexpr double kLeastSlope = 0.05;
  const double k1 = lens.k1(), k2 = lens.k2();
  double r = seen;
  for (int i = 0; i < kRounds; ++i) {
    const double r2 = r * r, slope = 1 + r2 * (3 * k1 + r2 * 5 * k2);
    if (!(slope > kLeastSlope)) return std::nullopt;
    const double step = (r * (1 + r2 * (k1 + r2 * k2)) - seen) / slope;
    r -= step;
    if (std::abs(step) < 1e-13) return r;
  }
  return std::nullopt;
}

}  // namespace

Eigen::Vector2d LensCorrection::raw_from_normalized(const CameraModel& camera, const Eigen::Vector2d& n,
                                                    Jacobians* jacobians) const {
  Eigen::Matrix2d d_by_n;
  const Eigen::Vector2d d = camera.distort_normalized(n, jacobians != nullptr ? &d_by_n : nullptr);
  const Eigen::Vector2d focal = focal_of(camera, *this);
  const double r2 = d.squaredNorm(), g = 1 + r2 * (k1() + r2 * k2());
  const Eigen::Vector2d fd = focal.cwiseProduct(d);
  if (jacobians != nullptr) {
    const Eigen::Matrix2d by_d = g * Eigen::Matrix2d::Identity() + 2 * (k1() + 2 * k2() * r2) * d * d.transpose();
    jacobians->by_normalized = focal.asDiagonal() * by_d * d_by_n;
    jacobians->by_values << g * fd, Eigen::Matrix2d::Identity(), r2 * fd, r2 * r2 * fd,
        0.5 * g * Eigen::Vector2d(-fd.x(), fd.y());
  }
  return Eigen::Vector2d(camera.cx, camera.cy) + centre_px() + g * fd;
}

std::optional<Eigen::Vector2d> LensCorrection::normalized_from_raw(const CameraModel& camera,
                                                                   const Eigen::Vector2d& raw_px) const {
  const Eigen::Vector2d m =
      (raw_px - Eigen::Vector2d(camera.cx, camera.cy) - centre_px()).cwiseQuotient(focal_of(camera, *this));
  const double seen = m.norm();
  const auto r = radius_of(*this, seen);
  if (!r) return std::nullopt;
  const Eigen::Vector2d d = seen > 0 ? Eigen::Vector2d(m * (*r / seen)) : m;
  const auto undistorted_px = camera.undistorted_from_raw(camera.pixel_from_normalized(d));
  if (!undistorted_px) return std::nullopt;
  return camera.normalized_from_pixel(*undistorted_px);
}

Eigen::Vector2d LensCorrection::raw_from_undistorted(const CameraModel& camera,
                                                     const Eigen::Vector2d& undistorted_px) const {
  if (none()) return camera.raw_from_undistorted(undistorted_px);
  return raw_from_normalized(camera, camera.normalized_from_pixel(undistorted_px));
}

std::optional<Eigen::Vector2d> LensCorrection::undistorted_from_calibrated(const CameraModel& camera,
                                                                           const Eigen::Vector2d& calibrated_px) const {
  if (none()) return calibrated_px;
  const auto n = normalized_from_raw(camera, camera.raw_from_undistorted(calibrated_px));
  if (!n) return std::nullopt;
  return camera.pixel_from_normalized(*n);
}

std::optional<Eigen::Vector2d> LensCorrection::calibrated_from_undistorted(
    const CameraModel& camera, const Eigen::Vector2d& undistorted_px) const {
  if (none()) return undistorted_px;
  return camera.undistorted_from_raw(raw_from_undistorted(camera, undistorted_px));
}

bool is_invertible(const CameraModel& camera, const LensCorrection& lens) {
  const double right = camera.width_px - 1, bottom = camera.height_px - 1;
  for (const double x : {0.0, 0.5 * right, right}) {
    for (const double y : {0.0, 0.5 * bottom, bottom}) {
      // Where the calibration itself has no answer the correction need not have one.
      const bool calibrated = camera.undistorted_from_raw({x, y}).has_value();
      if (calibrated && !lens.normalized_from_raw(camera, {x, y})) return false;
    }
  }
  return true;
}

}  // namespace coslam
