// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "common/geometry/lens_correction.h"

namespace coslam {

// Maps undistorted pixels of one lens of a camera to those of another, by the raw pixel. Refers to the camera.
class LensStep {
 public:
  LensStep(const CameraModel& camera, const LensCorrection& from, const LensCorrection& to)
      : camera_(camera), from_(camera, from), to_(camera, to), none_(from == to) {}

  bool none() const { return none_; }
  // Moves a pixel; it stays where it is when the new lens has no place for it.
  void move(Eigen::Vector2f* undistorted_px) const {
    if (none_) return;
    const Eigen::Vector2d normalized = camera_.normalized_from_pixel(undistorted_px->cast<double>());
    const auto n = to_.normalized_from_raw(from_.raw_from_normalized(normalized), normalized);
    if (n) *undistorted_px = camera_.pixel_from_normalized(*n).cast<float>();
  }

 private:
  const CameraModel& camera_;
  CorrectedLens from_, to_;
  bool none_;
};

}  // namespace coslam
