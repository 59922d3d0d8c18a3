// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/camera_model.h"

#include <Eigen/Geometry>
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

double equidistant_slope(const std::array<double, 8>& k, double theta) {
  const double t2 = theta * theta;
  return 1 + t2 * (3 * k[0] + t2 * (5 * k[1] + t2 * (7 * k[2] + t2 * 9 * k[3])));
}

// n scaled by a function of r2 = |n|^2.
Eigen::Vector2d scale_radially(const Eigen::Vector2d& n, double scale, double scale_by_r2, Eigen::Matrix2d* jacobian) {
  if (jacobian != nullptr) *jacobian = scale * Eigen::Matrix2d::Identity() + 2 * scale_by_r2 * n * n.transpose();
  return scale * n;
}

Eigen::Vector2d distort_equidistant(const std::array<double, 8>& k, const Eigen::Vector2d& n,
                                    Eigen::Matrix2d* jacobian) {
  const double r = n.norm();
  if (r < 1e-9) return scale_radially(n, 1, 0, jacobian);
  const double theta = std::atan(r), scale = equidistant_angle(k, theta) / r;
  const double by_r2 = (equidistant_slope(k, theta) / (1 + r * r) - scale) / (2 * r * r);
  return scale_radially(n, scale, r < 1e-5 ? 0.0 : by_r2, jacobian);
}

// Usenko et al. 2018, scaled so that the middle of the image keeps its size.
Eigen::Vector2d distort_double_sphere(const std::array<double, 8>& k, const Eigen::Vector2d& n,
                                      Eigen::Matrix2d* jacobian) {
  const double xi = k[0], alpha = k[1], r2 = n.squaredNorm(), d1 = std::sqrt(1 + r2), z = xi * d1 + 1;
  const double d2 = std::sqrt(r2 + z * z), den = alpha * d2 + (1 - alpha) * z;
  const double z_by_r2 = xi / (2 * d1), den_by_r2 = alpha * (1 + 2 * z * z_by_r2) / (2 * d2) + (1 - alpha) * z_by_r2;
  return scale_radially(n, (1 + xi) / den, -(1 + xi) * den_by_r2 / (den * den), jacobian);
}

std::array<double, 8> radtan_of_omni(const std::array<double, 8>& k) { return {k[1], k[2], k[3], k[4]}; }

// Mei and Rives 2007, scaled likewise.
Eigen::Vector2d distort_omni(const std::array<double, 8>& k, const Eigen::Vector2d& n, Eigen::Matrix2d* jacobian) {
  const double xi = k[0], d = std::sqrt(1 + n.squaredNorm()), scale = 1 / (1 + xi * d);
  Eigen::Matrix2d by_n;
  const Eigen::Vector2d m = scale_radially(n, scale, -scale * scale * xi / (2 * d), &by_n);
  const Eigen::Vector2d bent = distort_radtan(radtan_of_omni(k), m, jacobian);
  if (jacobian != nullptr) *jacobian = (1 + xi) * *jacobian * by_n;
  return (1 + xi) * bent;
}

// Where a ray meets the pinhole image, which has no place for rays at 90 degrees and beyond.
std::optional<Eigen::Vector2d> normalized_of_ray(const Eigen::Vector3d& ray) {
  constexpr double kLeastCosine = 0.0707;  // 1.5 rad
  if (!(ray.z() > kLeastCosine * ray.norm())) return std::nullopt;
  return ray.hnormalized();
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
    const double slope = equidistant_slope(k, theta);
    if (slope <= 1e-3) return std::nullopt;
    const double step = (equidistant_angle(k, theta) - rd) / slope;
    theta -= step;
    if (std::abs(step) < 1e-12) break;
  }
  if (!(theta > 0 && theta < 1.5) || std::abs(equidistant_angle(k, theta) - rd) > 1e-6) return std::nullopt;
  return d * (std::tan(theta) / rd);
}

std::optional<Eigen::Vector2d> undistort_double_sphere(const std::array<double, 8>& k, const Eigen::Vector2d& d) {
  const double xi = k[0], alpha = k[1];
  const Eigen::Vector2d m = d / (1 + xi);
  const double r2 = m.squaredNorm(), root = 1 - (2 * alpha - 1) * r2;
  if (root < 0) return std::nullopt;
  const double z = (1 - alpha * alpha * r2) / (alpha * std::sqrt(root) + 1 - alpha);
  const double under = z * z + (1 - xi * xi) * r2;
  if (under < 0) return std::nullopt;
  const double length = (z * xi + std::sqrt(under)) / (z * z + r2);
  return normalized_of_ray({length * m.x(), length * m.y(), length * z - xi});
}

std::optional<Eigen::Vector2d> undistort_omni(const std::array<double, 8>& k, const Eigen::Vector2d& d) {
  const double xi = k[0];
  const auto m = undistort_radtan(radtan_of_omni(k), d / (1 + xi));
  if (!m) return std::nullopt;
  const double r2 = m->squaredNorm(), root = 1 + (1 - xi * xi) * r2;
  if (root < 0) return std::nullopt;
  const double length = (xi + std::sqrt(root)) / (1 + r2);
  return normalized_of_ray({length * m->x(), length * m->y(), length - xi});
}

Eigen::Vector2d distort(const CameraModel& camera, const Eigen::Vector2d& n, Eigen::Matrix2d* jacobian) {
  switch (camera.distortion) {
    case DistortionModel::kRadTan:
      return distort_radtan(camera.coefficients, n, jacobian);
    case DistortionModel::kEquidistant:
      return distort_equidistant(camera.coefficients, n, jacobian);
    case DistortionModel::kDoubleSphere:
      return distort_double_sphere(camera.coefficients, n, jacobian);
    case DistortionModel::kOmni:
      return distort_omni(camera.coefficients, n, jacobian);
    case DistortionModel::kNone:
    case DistortionModel::kUnknown:
      break;
  }
  if (jacobian != nullptr) jacobian->setIdentity();
  return n;
}

std::optional<Eigen::Vector2d> undistort(const CameraModel& camera, const Eigen::Vector2d& d) {
  switch (camera.distortion) {
    case DistortionModel::kRadTan:
      return undistort_radtan(camera.coefficients, d);
    case DistortionModel::kEquidistant:
      return undistort_equidistant(camera.coefficients, d);
    case DistortionModel::kDoubleSphere:
      return undistort_double_sphere(camera.coefficients, d);
    case DistortionModel::kOmni:
      return undistort_omni(camera.coefficients, d);
    case DistortionModel::kNone:
    case DistortionModel::kUnknown:
      break;
  }
  return d;
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

Eigen::Vector2d CameraModel::distort_normalized(const Eigen::Vector2d& n, Eigen::Matrix2d* jacobian) const {
  return distort(*this, n, jacobian);
}

Eigen::Vector2d CameraModel::raw_from_undistorted(const Eigen::Vector2d& undistorted_px) const {
  return pixel_from_normalized(distort_normalized(normalized_from_pixel(undistorted_px)));
}

Eigen::Matrix2d CameraModel::raw_by_undistorted(const Eigen::Vector2d& undistorted_px) const {
  Eigen::Matrix2d j;
  distort(*this, normalized_from_pixel(undistorted_px), &j);
  j(0, 1) *= fx / fy;
  j(1, 0) *= fy / fx;
  return j;
}

std::optional<Eigen::Vector2d> CameraModel::undistorted_from_raw(const Eigen::Vector2d& raw_px) const {
  const auto n = undistort(*this, normalized_from_pixel(raw_px));
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
  // The image may be a region of the sensor that the optical axis does not meet.
  if (!(c.cx > -c.width_px && c.cx < 2 * c.width_px && c.cy > -c.height_px && c.cy < 2 * c.height_px)) {
    return "the principal point lies far outside the image";
  }
  for (const double k : c.coefficients) {
    if (!std::isfinite(k)) return "a distortion coefficient is not finite";
  }
  const bool sphere = c.distortion == DistortionModel::kDoubleSphere || c.distortion == DistortionModel::kOmni;
  if (sphere && !(c.coefficients[0] > -1)) return "xi of the lens must be above -1";
  if (c.distortion == DistortionModel::kDoubleSphere && !(c.coefficients[1] >= 0 && c.coefficients[1] <= 1)) {
    return "alpha of the lens must be between 0 and 1";
  }
  return std::nullopt;
}

}  // namespace coslam
