// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/camera_model.h"

#include <Eigen/LU>
#include <cmath>

namespace coslam {
namespace {

Eigen::Vector2d distort_radtan(const std::array<double, 8>& k, const Eigen::Vector2d& n, Eigen::Matrix2d* jacobian) {
  const double x = n.x(), y = n.y(), r2 = x * x + y * y;
  const double num = 1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  const double den = 1 + r2 * (k[5] + r2 * (k[6] + r2 * k[7]));
  const double radial = num / den;
  if (jacobian != nullptr) {
    const double dnum = k[0] + r2 * (2 * k[1] + r2 * 3 * k[4]);
    const double dden = k[5] + r2 * (2 * k[6] + r2 * 3 * k[7]);
    const double dradial = (dnum * den - num * dden) / (den * den);  // by r2
    (*jacobian)(0, 0) = radial + 2 * x * x * dradial + 2 * k[2] * y + 6 * k[3] * x;
    (*jacobian)(0, 1) = 2 * x * y * dradial + 2 * k[2] * x + 2 * k[3] * y;
    (*jacobian)(1, 0) = 2 * x * y * dradial + 2 * k[2] * x + 2 * k[3] * y;
    (*jacobian)(1, 1) = radial + 2 * y * y * dradial + 6 * k[2] * y + 2 * k[3] * x;
  }
  return {x * radial + 2 * k[2] * x * y + k[3] * (r2 + 2 * x * x),
          y * radial + k[2] * (r2 + 2 * y * y) + 2 * k[3] * x * y};
}

double equidistant_angle(const std::array<double, 8>& k, double theta) {
  const double t2 = theta * theta;
  return theta * (1 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
}

Eigen::Vector2d distort_equidistant(const std::array<double, 8>& k, const Eigen::Vector2d& n) {
  const double r = n.norm();
  if (r < 1e-9) return n;
  return n * (equidistant_angle(k, std::atan(r)) / r);
}

std::optional<Eigen::Vector2d> undistort_radtan(const std::array<double, 8>& k, const Eigen::Vector2d& d) {
  Eigen::Vector2d n = d;
  for (int i = 0; i < 20; ++i) {
    Eigen::Matrix2d j;
    const Eigen::Vector2d error = distort_radtan(k, n, &j) - d;
    if (j.determinant() <= 1e-3) return std::nullopt;  // past the fold of the polynomial
    const Eigen::Vector2d step = j.inverse() * error;
    n -= step;
    if (step.squaredNorm() < 1e-20) return n;
  }
  return (distort_radtan(k, n, nullptr) - d).norm() < 1e-6 ? std::optional(n) : std::nullopt;
}

std::optional<Eigen::Vector2d> undistort_equidistant(const std::array<double, 8>& k, const Eigen::Vector2d& d) {
  const double rd = d.norm();
  if (rd < 1e-9) return d;
  double theta = rd;
  for (int i = 0; i < 20; ++i) {
    const double t2 = theta * theta;
    const double slope = 1 + t2 * (3 * k[0] + t2 * (5 * k[1] + t2 * (7 * k[2] + t2 * 9 * k[3])));
    if (slope <= 1e-3) return std::nullopt;
    const double step = (equidistant_angle(k, theta) - rd) / slope;
    theta -= step;
    if (std::abs(step) < 1e-12) break;
  }
  // A pinhole image has no place for rays at 90 degrees and beyond.
  if (!(theta > 0 && theta < 1.5) || std::abs(equidistant_angle(k, theta) - rd) > 1e-6) return std::nullopt;
  return d * (std::tan(theta) / rd);
}

}  // namespace

bool CameraModel::contains_raw(const Eigen::Vector2d& px, double margin_px) const {
  return px.x() >= margin_px && px.y() >= margin_px && px.x() <= width_px - 1 - margin_px &&
         px.y() <= height_px - 1 - margin_px;
}

Eigen::Matrix<double, 2, 3> CameraModel::project_jacobian(const Eigen::Vector3d& in_cam) const {
  const double iz = 1.0 / in_cam.z();
  Eigen::Matrix<double, 2, 3> j;
  j << fx * iz, 0, -fx * in_cam.x() * iz * iz, 0, fy * iz, -fy * in_cam.y() * iz * iz;
  return j;
}

Eigen::Vector2d CameraModel::distort_normalized(const Eigen::Vector2d& n) const {
  switch (distortion) {
    case DistortionModel::kRadTan:
      return distort_radtan(coefficients, n, nullptr);
    case DistortionModel::kEquidistant:
      return distort_equidistant(coefficients, n);
    case DistortionModel::kNone:
      break;
  }
  return n;
}

Eigen::Vector2d CameraModel::raw_from_undistorted(const Eigen::Vector2d& undistorted_px) const {
  return pixel_from_normalized(distort_normalized(normalized_from_pixel(undistorted_px)));
}

std::optional<Eigen::Vector2d> CameraModel::undistorted_from_raw(const Eigen::Vector2d& raw_px) const {
  const Eigen::Vector2d d = normalized_from_pixel(raw_px);
  std::optional<Eigen::Vector2d> n = d;
  if (distortion == DistortionModel::kRadTan) n = undistort_radtan(coefficients, d);
  if (distortion == DistortionModel::kEquidistant) n = undistort_equidistant(coefficients, d);
  if (!n) return std::nullopt;
  return pixel_from_normalized(*n);
}

std::optional<const char*> problem_of(const CameraModel& c) {
  if (c.width_px < 16 || c.height_px < 16 || c.width_px > 16384 || c.height_px > 16384) {
    return "the image size must be between 16 and 16384 pixels a side";
  }
  if (!(c.fx > 0 && c.fy > 0) || !std::isfinite(c.fx) || !std::isfinite(c.fy)) {
    return "the focal lengths must be positive and finite";
  }
  if (!(c.cx > 0 && c.cx < c.width_px && c.cy > 0 && c.cy < c.height_px)) {
    return "the principal point lies outside the image";
  }
  for (const double k : c.coefficients) {
    if (!std::isfinite(k)) return "a distortion coefficient is not finite";
  }
  return std::nullopt;
}

}  // namespace coslam
