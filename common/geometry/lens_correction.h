// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "common/geometry/camera_model.h"
#include "common/geometry/rigid3.h"

namespace coslam {

// What a calibration gets wrong of its lens. A point at n = (x/z, y/z), which the distortion of the calibration takes
// to d, is seen in the raw image at
//   c + centre + F e^log_focal d (1 + k1 |d|^2 + k2 |d|^4),  F = diag(fx e^(-log_aspect/2), fy e^(log_aspect/2))
// With it, as without, an undistorted px is that of the pinhole with the calibration's fx, fy, cx, cy: the correction
// says where in the raw image that is. What an agent sends is undistorted by its calibration alone.
struct LensCorrection {
  Vector6d values = Vector6d::Zero();  // log_focal, centre x, centre y (pixels), k1, k2, log_aspect

  bool none() const { return values.isZero(0); }
  double log_focal() const { return values[0]; }
  Eigen::Vector2d centre_px() const { return values.segment<2>(1); }
  double k1() const { return values[3]; }
  double k2() const { return values[4]; }
  double log_aspect() const { return values[5]; }

  struct Jacobians {
    Eigen::Matrix2d by_normalized;
    Eigen::Matrix<double, 2, 6> by_values;
  };
  Eigen::Vector2d raw_from_normalized(const CameraModel& camera, const Eigen::Vector2d& n,
                                      Jacobians* jacobians = nullptr) const;
  // Empty where it cannot be inverted.
  std::optional<Eigen::Vector2d> normalized_from_raw(const CameraModel& camera, const Eigen::Vector2d& raw_px) const;

  Eigen::Vector2d raw_from_undistorted(const CameraModel& camera, const Eigen::Vector2d& undistorted_px) const;
  // From what the calibration alone makes of a raw pixel, and to it; empty where either cannot be inverted.
  std::optional<Eigen::Vector2d> undistorted_from_calibrated(const CameraModel& camera,
                                                             const Eigen::Vector2d& calibrated_px) const;
  std::optional<Eigen::Vector2d> calibrated_from_undistorted(const CameraModel& camera,
                                                             const Eigen::Vector2d& undistorted_px) const;

  friend bool operator==(const LensCorrection& a, const LensCorrection& b) { return a.values == b.values; }
};

// Every pixel of the image has a place in the undistorted one, and those farther out lie farther out there.
bool is_invertible(const CameraModel& camera, const LensCorrection& lens);

}  // namespace coslam
