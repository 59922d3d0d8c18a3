// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "common/base/workers.h"
#include "common/geometry/rigid3.h"
#include "common/geometry/triangulation.h"
#include "server/estimator/solve/matching.h"

namespace coslam {

// Relative pose of two images by their rig; empty when their cameras are not of one rig.
std::optional<Rigid3> by_rig(const FeatureImage& first, const FeatureImage& second);

struct StartConfig {
  double sigma_px = 1.0;  // standard deviation of a keypoint, at 640 px image width
  int min_matches = 30;   // inliers of the essential matrix of the best pair; half as many for each further camera
  double min_parallax_rad = kNewView_rad;  // median over the pair's points
};

struct StartResult {
  bool ok = false;
  std::string reason;                                 // reason of a failure, one sentence
  std::vector<std::optional<Rigid3>> cam_from_world;  // one per image; empty when it could not be placed
  struct Point {
    Eigen::Vector3d position;
    std::vector<std::pair<int, int>> seen;  // image, feature
  };
  std::vector<Point> points;
  int first = 0, second = 0;  // the best pair; `first` is the origin
  bool metric = false;        // metres, because a rig determines the scale
};

// Makes a map from images of one instant (paper: all cameras look at one scene): the pair with the most well-spread
// matches and enough parallax gives an essential matrix, others are added by PnP, bundle adjustment at the end. The
// frame is that of the first image of the pair; the length unit is the distance between the pair. Where two cameras of
// a rig see the same, they are the pair, their relative pose is the rig's, unless their images contradict it, and
// lengths are metres. Of more than a dozen images each is compared only with the few that look most like it and with
// those of its rig.
StartResult start_map(const std::vector<FeatureImage>& images, const StartConfig& config,
                      Workers& workers = Workers::alone());

// Makes a map from two images whose matches are known (two views of one camera's tracks).
StartResult start_from_matches(const FeatureImage& first, const FeatureImage& second,
                               const std::vector<FeatureMatch>& matches, const StartConfig& config);

}  // namespace coslam
