// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <vector>

#include "server/estimator/map/map.h"
#include "server/estimator/motion/moving_path.h"

namespace coslam {

// The newest part of the paths of the map's moving points, kept from frame set to frame set and where the map now has
// it.
class FollowedPaths {
 public:
  // Where a sample lies for the cameras that saw it: it follows when the map moves, at less than a triangulation each.
  struct Anchor {
    CameraId first, second;
    Eigen::Vector3d in_first = Eigen::Vector3d::Zero();
    double baseline = 0;
  };
  struct Path {
    MovingPath samples;
    std::vector<Anchor> anchors;  // one for each
  };

  // Of the points that move now, from that instant on.
  void update(const Map& map, TimeNs since_ns);
  const std::map<PointId, Path>& all() const { return paths_; }

 private:
  static std::optional<Anchor> anchor_of(const Map& map, MapId in, const MotionSample& sample,
                                         const Eigen::Vector3d& position);
  static bool follow(const Map& map, MapId in, Anchor* anchor, PathSample* sample);
  static void extend(const Map& map, const MapPoint& point, TimeNs since_ns, Path* path);

  std::map<PointId, Path> paths_;
  MapEpoch epoch_;  // of the paths
};

}  // namespace coslam
