// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "common/base/workers.h"
#include "common/geometry/rigid3.h"
#include "server/estimator/solve/matching.h"

namespace coslam {

// How the second camera lies to the first by their rig; empty when they are not of one.
std::optional<Rigid3> by_rig(const FeatureImage& first, const FeatureImage& second);

struct StartConfig {
  double sigma_px = 1.0;  // of a descriptor's keypoint, at 640 px image width
  int min_matches = 30;   // inliers of the essential matrix between the best pair; half as many for a camera more
  double min_parallax_rad = 0.02;  // median over the pair's points
};

struct StartResult {
  bool ok = false;
  std::string reason;                                 // why not, one sentence
  std::vector<std::optional<Rigid3>> cam_from_world;  // per image; empty when it could not be placed
  struct Point {
    Eigen::Vector3d position;
    std::vector<std::pair<int, int>> seen;  // image, feature
  };
  std::vector<Point> points;
  int first = 0, second = 0;  // the best pair; `first` is the origin
  bool metric = false;        // a rig tells lengths
};

// Map from images of one instant (paper: all cameras look at one scene): the pair with the most well-spread matches and
// enough parallax gives an essential matrix, others are added by PnP, bundle adjustment at the end. The frame is that
// of the first image of the pair; the length unit is the distance between the pair. Where two cameras of a rig see the
// same, they are the pair, their relative pose is the rig's, unless their images contradict it, and lengths are metres.
// Of more than a dozen images each is compared with the few others that look most like it.
StartResult start_map(const std::vector<FeatureImage>& images, const StartConfig& config,
                      Workers& workers = Workers::alone());

// The same from two images whose matches are known (two views of one camera's tracks).
StartResult start_from_matches(const FeatureImage& first, const FeatureImage& second,
                               const std::vector<FeatureMatch>& matches, const StartConfig& config);

}  // namespace coslam
