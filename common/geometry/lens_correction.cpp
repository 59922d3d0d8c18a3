// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/lens_correction.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace coslam {
namespace {

using Radial = Eigen::Matrix<double, LensCorrection::kRadial, 1>;

Eigen::Vector2d focal_of(const CameraModel& camera, const LensCorrection& lens) {
  const double half = 0.5 * lens.log_aspect();
  return {camera.fx * std::exp(lens.log_focal() - half), camera.fy * std::exp(lens.log_focal() + half)};
}

// P_j(2u - 1) - P_j(-1) for j = 1 ..., and their derivatives by u. Beyond the corners they go on as they are there.
struct RadialTerms {
  Radial value, slope;
  explicit RadialTerms(double u) {
    constexpr double kMost = 1.1;
    const double x = 2 * std::min(u, kMost) - 1, inside = u < kMost ? 2 : 0;
    double before = 1, now = x, slope_before = 0, slope_now = 1, at_centre = -1;
    for (int j = 1; j <= LensCorrection::kRadial; ++j) {
      value[j - 1] = now - at_centre;
      slope[j - 1] = inside * slope_now;
      const double next = ((2 * j + 1) * x * now - j * before) / (j + 1);
      const double slope_next = ((2 * j + 1) * (now + x * slope_now) - j * slope_before) / (j + 1);
      before = now;
      now = next;
      slope_before = slope_now;
      slope_now = slope_next;
      at_centre = -at_centre;
    }
  }
};

// What u is of |m|^2: it depends on the raw pixel alone, so that the terms reach to the corners whatever the focal
// length.
double per_corner2(const CameraModel& camera, const LensCorrection& lens) {
  return 4 * std::exp(2 * lens.log_focal()) /
         (std::pow(camera.width_px / camera.fx, 2) + std::pow(camera.height_px / camera.fy, 2));
}

// g(u) m + t(m), and its derivative by m. terms: of the place.
Eigen::Vector2d bent(const LensCorrection& lens, const RadialTerms& terms, double per_r2, const Eigen::Vector2d& m,
                     Eigen::Matrix2d* by_m) {
  const double r2 = m.squaredNorm(), x = m.x(), y = m.y(), p1 = lens.values[4], p2 = lens.values[5];
  const Radial a = lens.radial();
  const double g = 1 + a.dot(terms.value), g_by_r2 = a.dot(terms.slope) * per_r2, cross = 2 * (p1 * x + p2 * y);
  *by_m = g * Eigen::Matrix2d::Identity() + 2 * g_by_r2 * m * m.transpose();
  (*by_m)(0, 0) += 2 * p1 * y + 6 * p2 * x;
  (*by_m)(0, 1) += cross;
  (*by_m)(1, 0) += cross;
  (*by_m)(1, 1) += 6 * p1 * y + 2 * p2 * x;
  return g * m + Eigen::Vector2d(2 * p1 * x * y + p2 * (r2 + 2 * x * x), p1 * (r2 + 2 * y * y) + 2 * p2 * x * y);
}

// m of bent(m) = d, and the derivative of bent() there; as near as it comes where there is none.
Eigen::Vector2d unbent(const LensCorrection& lens, double per_r2, const Eigen::Vector2d& d, Eigen::Matrix2d* by_m) {
  constexpr int kRounds = 20;
  constexpr double kLeastDeterminant = 0.01, kLongest = 0.3, kLast2 = 1e-18;
  Eigen::Vector2d m = d;
  for (int i = 0; i < kRounds; ++i) {
    const Eigen::Vector2d off = bent(lens, RadialTerms(m.squaredNorm() * per_r2), per_r2, m, by_m) - d;
    if (!(by_m->determinant() > kLeastDeterminant)) by_m->setIdentity();
    Eigen::Vector2d step = by_m->inverse() * off;
    const double length = step.norm();
    if (length > kLongest) step *= kLongest / length;
    m -= step;
    if (step.squaredNorm() < kLast2) break;
  }
  return m;
}

}  // namespace

Eigen::Vector2d LensCorrection::raw_from_normalized(const CameraModel& camera, const Eigen::Vector2d& n,
                                                    Jacobians* jacobians) const {
  return CorrectedLens(camera, *this).raw_from_normalized(n, jacobians);
}

std::optional<Eigen::Vector2d> LensCorrection::normalized_from_raw(const CameraModel& camera,
                                                                   const Eigen::Vector2d& raw_px) const {
  const auto near_px = camera.undistorted_from_raw(raw_px);
  if (!near_px) return std::nullopt;
  return CorrectedLens(camera, *this).normalized_from_raw(raw_px, camera.normalized_from_pixel(*near_px));
}

CorrectedLens::CorrectedLens(const CameraModel& camera, const LensCorrection& lens)
    : camera_(&camera),
      lens_(lens),
      focal_(focal_of(camera, lens)),
      centre_(Eigen::Vector2d(camera.cx, camera.cy) + lens.centre_px()),
      per_corner2_(per_corner2(camera, lens)) {}

Eigen::Vector2d CorrectedLens::raw_from_normalized(const Eigen::Vector2d& n,
                                                   LensCorrection::Jacobians* jacobians) const {
  Eigen::Matrix2d d_by_n, by_m;
  const Eigen::Vector2d d = camera_->distort_normalized(n, jacobians != nullptr ? &d_by_n : nullptr);
  const Eigen::Vector2d m = unbent(lens_, per_corner2_, d, &by_m), at = focal_.cwiseProduct(m);
  if (jacobians == nullptr) return centre_ + at;
  const double r2 = m.squaredNorm(), x = m.x(), y = m.y();
  const RadialTerms terms(r2 * per_corner2_);
  bent(lens_, terms, per_corner2_, m, &by_m);
  const Eigen::Matrix2d raw_by_d = focal_.asDiagonal() * by_m.inverse();
  jacobians->by_normalized = raw_by_d * d_by_n;
  auto& j = jacobians->by_values;
  j.col(0) = at - raw_by_d * m * (2 * r2 * per_corner2_ * lens_.radial().dot(terms.slope));
  j.middleCols<2>(1).setIdentity();
  j.col(3) << -0.5 * at.x(), 0.5 * at.y();
  j.col(4) = -raw_by_d * Eigen::Vector2d(2 * x * y, r2 + 2 * y * y);
  j.col(5) = -raw_by_d * Eigen::Vector2d(r2 + 2 * x * x, 2 * x * y);
  j.rightCols<LensCorrection::kRadial>() = -raw_by_d * m * terms.value.transpose();
  return centre_ + at;
}

std::optional<Eigen::Vector2d> CorrectedLens::normalized_from_raw(const Eigen::Vector2d& raw_px,
                                                                  const Eigen::Vector2d& near) const {
  constexpr int kRounds = 20;
  constexpr double kLeastShare = 1e-3;  // of the area that a pixel has in the middle
  constexpr double kLast2 = 4e-8;       // a step so small leaves its square
  Eigen::Matrix2d by_m;
  const Eigen::Vector2d m = (raw_px - centre_).cwiseQuotient(focal_);
  const Eigen::Vector2d d = bent(lens_, RadialTerms(m.squaredNorm() * per_corner2_), per_corner2_, m, &by_m);
  if (!(by_m.determinant() > kLeastShare)) return std::nullopt;
  Eigen::Vector2d n = near;
  for (int i = 0; i < kRounds; ++i) {
    Eigen::Matrix2d by_n;
    const Eigen::Vector2d off = camera_->distort_normalized(n, &by_n) - d;
    if (!(by_n.determinant() > kLeastShare)) return std::nullopt;
    const Eigen::Vector2d step = by_n.inverse() * off;
    n -= step;
    if (step.squaredNorm() < kLast2) return n;
  }
  return std::nullopt;
}

std::optional<Eigen::Vector2d> CorrectedLens::undistorted_from_calibrated(const Eigen::Vector2d& calibrated_px) const {
  const Eigen::Vector2d near = camera_->normalized_from_pixel(calibrated_px);
  const auto n = normalized_from_raw(camera_->pixel_from_normalized(camera_->distort_normalized(near)), near);
  if (!n) return std::nullopt;
  return camera_->pixel_from_normalized(*n);
}

Eigen::Vector2d LensCorrection::raw_from_undistorted(const CameraModel& camera,
                                                     const Eigen::Vector2d& undistorted_px) const {
  if (none()) return camera.raw_from_undistorted(undistorted_px);
  return raw_from_normalized(camera, camera.normalized_from_pixel(undistorted_px));
}

std::optional<Eigen::Vector2d> LensCorrection::undistorted_from_calibrated(const CameraModel& camera,
                                                                           const Eigen::Vector2d& calibrated_px) const {
  if (none()) return calibrated_px;
  return CorrectedLens(camera, *this).undistorted_from_calibrated(calibrated_px);
}

std::optional<Eigen::Vector2d> LensCorrection::calibrated_from_undistorted(
    const CameraModel& camera, const Eigen::Vector2d& undistorted_px) const {
  if (none()) return undistorted_px;
  return camera.undistorted_from_raw(raw_from_undistorted(camera, undistorted_px));
}

bool is_invertible(const CameraModel& camera, const LensCorrection& lens) {
  constexpr int kAcross = 16, kDown = 12;
  for (int i = 0; i <= kAcross; ++i) {
    for (int j = 0; j <= kDown; ++j) {
      const Eigen::Vector2d raw_px(i * (camera.width_px - 1.0) / kAcross, j * (camera.height_px - 1.0) / kDown);
      const bool calibrated = camera.undistorted_from_raw(raw_px).has_value();
      if (calibrated && !lens.normalized_from_raw(camera, raw_px)) return false;
    }
  }
  return true;
}

bool may_be(const CameraModel& camera, const LensCorrection& lens) {
  LensCorrection::Values sizes = lens.values.cwiseAbs();
  sizes.segment<2>(1) /= camera.width_px;
  return sizes.allFinite() && sizes.maxCoeff() < LensCorrection::kMost && is_invertible(camera, lens);
}

}  // namespace coslam
