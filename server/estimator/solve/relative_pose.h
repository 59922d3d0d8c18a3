// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "common/geometry/rigid3.h"
#include "server/estimator/solve/matching.h"
#include "server/estimator/solve/start.h"

namespace coslam {

// Relative pose of two images by their matches. Its length unit is the distance of the two, or metres.
struct RelativePose {
  int first = 0, second = 0;  // images
  std::vector<FeatureMatch> inliers;
  Rigid3 second_from_first;
  double median_parallax_rad = 0;
  double score = 0;     // worth as the first pair of a map
  bool metric = false;  // the rig determines the scale
};

// Estimates the relative pose of images a and b from their matches: by the rig that both are of, unless the images
// contradict it, else by their essential matrix. Empty when too few matches fit or the parallax is too small.
std::optional<RelativePose> relative_pose(const std::vector<FeatureImage>& images, int a, int b,
                                          const std::vector<FeatureMatch>& matches, const StartConfig& config);

}  // namespace coslam
