// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/camera_model.h"

#include <cmath>

namespace coslam {

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
  return visit_lens(distortion, [&](auto lens) { return lens.distort(coefficients, n, jacobian); });
}

Eigen::Vector2d CameraModel::raw_from_undistorted(const Eigen::Vector2d& undistorted_px) const {
  return pixel_from_normalized(distort_normalized(normalized_from_pixel(undistorted_px)));
}

Eigen::Matrix2d CameraModel::raw_by_undistorted(const Eigen::Vector2d& undistorted_px) const {
  Eigen::Matrix2d j;
  distort_normalized(normalized_from_pixel(undistorted_px), &j);
  j(0, 1) *= fx / fy;
  j(1, 0) *= fy / fx;
  return j;
}

std::optional<Eigen::Vector2d> CameraModel::undistorted_from_raw(const Eigen::Vector2d& raw_px) const {
  const Eigen::Vector2d d = normalized_from_pixel(raw_px);
  const auto n = visit_lens(distortion, [&](auto lens) { return lens.undistort(coefficients, d); });
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
  return visit_lens(c.distortion, [&](auto lens) { return lens.problem(c.coefficients); });
}

}  // namespace coslam
