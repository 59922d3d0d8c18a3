// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "common/geometry/camera_model.h"

namespace coslam {

// Correction of the lens of a calibration. A raw pixel
//   c + centre + F e^log_focal m,  F = diag(fx e^(-log_aspect/2), fy e^(log_aspect/2))
// shows what the distortion of the calibration takes to
//   d = g(u) m + t(m),  g(u) = 1 + sum_j radial_j (P_j(2u - 1) - P_j(-1)),  u = (e^log_focal |m| / R)^2
// with R such that u is 1 at the corners of the image, Legendre's polynomials P_j, and t, tangential terms as radtan
// has them. It is bounded by the image whatever the lens. Real lenses leave tenths of a pixel to what calibrations can
// say of them, up and down along the radius; without terms for that focal lengths follow it. With the correction, as
// without, an undistorted px is that of the pinhole with the calibration's fx, fy, cx, cy: the correction says where in
// the raw image that is. What an agent sends is undistorted by its calibration alone.
struct LensCorrection {
  static constexpr int kRadial = 6, kTerms = 6 + kRadial;
  static constexpr double kMost = 3;  // size of a value that may be, but for the centre
  using Values = Eigen::Matrix<double, kTerms, 1>;
  // log_focal, centre x, centre y (pixels), log_aspect, p1, p2, radial
  Values values = Values::Zero();

  bool none() const { return values.isZero(0); }
  double log_focal() const { return values[0]; }
  Eigen::Vector2d centre_px() const { return values.segment<2>(1); }
  double log_aspect() const { return values[3]; }
  Eigen::Vector2d tangential() const { return values.segment<2>(4); }
  Eigen::Matrix<double, kRadial, 1> radial() const { return values.tail<kRadial>(); }

  struct Jacobians {
    Eigen::Matrix2d by_normalized;
    Eigen::Matrix<double, 2, kTerms> by_values;
  };
  Eigen::Vector2d raw_from_normalized(const CameraModel& camera, const Eigen::Vector2d& n,
                                      Jacobians* jacobians = nullptr) const;
  // Direction of a raw pixel; empty where the model cannot be inverted.
  std::optional<Eigen::Vector2d> normalized_from_raw(const CameraModel& camera, const Eigen::Vector2d& raw_px) const;

  Eigen::Vector2d raw_from_undistorted(const CameraModel& camera, const Eigen::Vector2d& undistorted_px) const;
  // Converts between undistorted px and what the calibration alone makes of the raw pixel; empty where one of the two
  // models cannot be inverted.
  std::optional<Eigen::Vector2d> undistorted_from_calibrated(const CameraModel& camera,
                                                             const Eigen::Vector2d& calibrated_px) const;
  std::optional<Eigen::Vector2d> calibrated_from_undistorted(const CameraModel& camera,
                                                             const Eigen::Vector2d& undistorted_px) const;

  friend bool operator==(const LensCorrection& a, const LensCorrection& b) { return a.values == b.values; }
};

// A camera with what is wrong about its lens, worked out once for many pixels. Refers to the camera.
class CorrectedLens {
 public:
  CorrectedLens(const CameraModel& camera, const LensCorrection& lens);

  const LensCorrection& lens() const { return lens_; }
  Eigen::Vector2d raw_from_normalized(const Eigen::Vector2d& n, LensCorrection::Jacobians* jacobians = nullptr) const;
  // Direction of a raw pixel, found from a place near it, to 1e-4 px; empty where the model cannot be inverted.
  std::optional<Eigen::Vector2d> normalized_from_raw(const Eigen::Vector2d& raw_px, const Eigen::Vector2d& near) const;
  std::optional<Eigen::Vector2d> undistorted_from_calibrated(const Eigen::Vector2d& calibrated_px) const;

 private:
  const CameraModel* camera_;
  LensCorrection lens_;
  Eigen::Vector2d focal_, centre_;
  double per_corner2_;
};

// Whether every pixel of the image that the calibration has a place for has one with the correction, too.
bool is_invertible(const CameraModel& camera, const LensCorrection& lens);
// Whether is_invertible() holds and all values are in the range that the wire carries.
bool may_be(const CameraModel& camera, const LensCorrection& lens);

}  // namespace coslam
