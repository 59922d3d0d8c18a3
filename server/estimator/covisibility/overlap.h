// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <vector>

#include "server/estimator/map/map.h"

namespace coslam {

// Longest time between frames of two cameras that count as simultaneous: cameras come at different rates and moments,
// and frames get lost.
inline constexpr double kOneTime_s = 0.15;

// Shares of two views that are common to both, 0 to 1.
struct OverlapShares {
  double of_first = 0, of_second = 0;
  double least() const { return std::min(of_first, of_second); }
};

// Computes how far the views of cameras overlap at this set according to the map (paper 6.2: map points of one camera
// projected into the other), whether or not any point was found in both. A static point that one camera follows counts
// when it projects into the other's image, from not too different a direction, where the points that the other follows
// around it are about as far away: nearer things would hide it, and what two cameras see from far apart may be the two
// sides of a wall. Shares are of the cells of the image in which a camera follows anything.
class ViewOverlap {
 public:
  explicit ViewOverlap(const Map& map) : map_(map) {}
  // Compares the newest frames of two cameras; 0 when these are not of about one time, or have no pose in one map.
  OverlapShares between(CameraId first, CameraId second);

 private:
  static constexpr int kColumns = 12, kRows = 9;
  struct Seen {
    Eigen::Vector3d position;  // world
    int cell;
  };
  struct Depths {
    double least = std::numeric_limits<double>::infinity(), most = 0;
  };
  // Static points that one camera follows, and the range of their depths for each cell of its image.
  struct Sight {
    std::vector<Seen> seen;
    std::array<Depths, kColumns * kRows> depths;
  };

  const Sight& sight_of(const MapCamera& camera);
  static int cell_of(const CameraModel& model, const Eigen::Vector2d& px);
  static bool should_see(const MapCamera& camera, const Sight& sight, const Eigen::Vector3d& position);
  static double share_seen(const CameraFrames& seen_camera, const Sight& seen_sight, const MapCamera& seeing_camera,
                           const Sight& seeing_sight);

  const Map& map_;
  std::map<CameraId, Sight> sights_;
};

}  // namespace coslam
