// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "common/geometry/rigid3.h"

namespace coslam {

// Motion between two images that explains their matches.
struct TwoViewMotion {
  Rigid3 second_from_first;  // translation of length 1
  std::vector<bool> fits;    // matches on their epipolar line and in front of both cameras
  int support = 0;           // number of matches that fit
};

// Finds the best of the motions of the essential matrix and of the homography, from matches in normalized coordinates
// of which part may be wrong; threshold in the same unit. Matches on one plane fit two essential matrices alike, and
// only the depths of the points select the right one. Empty when there are fewer than eight, when a rotation alone
// explains the matches, or when two different motions explain them. Random matches have some best motion too, with
// little support.
std::optional<TwoViewMotion> two_view_motion(const std::vector<Eigen::Vector2d>& first,
                                             const std::vector<Eigen::Vector2d>& second, double threshold);

}  // namespace coslam
