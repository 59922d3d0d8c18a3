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

// Newest part of the paths of the map's moving points, kept from frame set to frame set and corrected with the map.
class FollowedPaths {
 public:
  // Position of a sample relative to the cameras that saw it, so that it follows corrections of the map for less than a
  // triangulation each.
  struct Anchor {
    CameraId first, second;
    Eigen::Vector3d in_first = Eigen::Vector3d::Zero();
    double baseline = 0;
  };
  struct Path {
    MovingPath samples;
    std::vector<Anchor> anchors;  // one per sample
  };

  // Updates the paths of the points that move now, from since_ns on.
  void update(const Map& map, TimeNs since_ns);
  const std::map<PointId, Path>& all() const { return paths_; }

 private:
  static std::optional<Anchor> anchor_of(const Map& map, MapId in, const MotionSample& sample,
                                         const Eigen::Vector3d& position);
  static bool follow(const Map& map, MapId in, Anchor* anchor, PathSample* sample);
  static void extend(const Map& map, const MapPoint& point, TimeNs since_ns, Path* path);

  std::map<PointId, Path> paths_;
  MapEpoch epoch_;  // epoch that the paths belong to
};

}  // namespace coslam
