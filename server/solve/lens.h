// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>

#include "common/geometry/camera_model.h"

namespace coslam {

// How a lens differs from its calibration, on the undistorted image that follows from that: a point at n = (x/z, y/z)
// is seen at
//   c + centre + e^log_focal f n (1 + k1 |n|^2 + k2 |n|^4)
struct LensChange {
  std::array<double, 5> values{};  // log_focal, centre x, centre y (pixels), k1, k2

  double log_focal() const { return values[0]; }
  Eigen::Vector2d centre_px() const { return {values[1], values[2]}; }
  // Undistorted pixel by the calibration of a point in the camera frame; z must be positive.
  Eigen::Vector2d project(const CameraModel& camera, const Eigen::Vector3d& in_cam) const;
  // Where the calibration alone would have it: the inverse, so that camera.project(p) is there when project(p) is at
  // px.
  Eigen::Vector2d undone(const CameraModel& camera, const Eigen::Vector2d& px) const;
};

// Standard deviations of a nominal calibration's errors, before anything was seen.
std::array<double, 5> nominal_lens_sigma(const CameraModel& camera);

}  // namespace coslam
