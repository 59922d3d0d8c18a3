// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "common/geometry/lens_correction.h"

namespace coslam {

// From where one lens of a camera has a raw pixel in the undistorted image to where another one has it.
class LensStep {
 public:
  LensStep(const CameraModel& camera, const LensCorrection& from, const LensCorrection& to)
      : camera_(camera), from_(from), to_(to), none_(from == to) {}

  bool none() const { return none_; }
  // Stays where it is when the new lens has no place for it.
  void move(Eigen::Vector2f* undistorted_px) const {
    if (none_) return;
    const auto n = to_.normalized_from_raw(camera_, from_.raw_from_undistorted(camera_, undistorted_px->cast<double>()));
    if (n) *undistorted_px = camera_.pixel_from_normalized(*n).cast<float>();
  }

 private:
  const CameraModel& camera_;
  LensCorrection from_, to_;
  bool none_;
};

}  // namespace coslam
