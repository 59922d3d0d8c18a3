// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "agent/track/pyramid.h"

namespace coslam {

// Evidence that a moving track follows an outline, collected while it moves. Where something moves in front of the
// rest, windows reach over its outline: what they follow is the outline, which is no place on anything. Then their
// middle does not go along with them: seen from image to image it changes, in standard deviation, more than half as
// much as it would had it stayed with the rest. Thread-compatible.
class OutlineEvidence {
 public:
  // Adds a pair of images: the track, now at px, moved by motion_px, the rest beside it by rest_motion_px. Tells
  // whether the track follows an outline, as far as is known by now; two motions that hardly differ tell nothing.
  bool add(const PyramidLevel& before, const PyramidLevel& now, const Eigen::Vector2f& px,
           const Eigen::Vector2f& motion_px, const Eigen::Vector2f& rest_motion_px);

 private:
  // Change of the middle from image to image, summed up, if it goes with the track or with the rest.
  float track_difference_ = 0, rest_difference_ = 0;
  int comparisons_ = 0;
};

}  // namespace coslam
