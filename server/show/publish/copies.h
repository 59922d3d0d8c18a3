// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "server/estimator/map/map.h"
#include "server/estimator/motion/objects.h"
#include "server/show/publish/odom_frames.h"
#include "server/show/publish/snapshot.h"

// Parts of a snapshot, copied from the map.
namespace coslam {

// server_run: whose poses of agents are in this map.
PublicPoses copy_poses(const Map& map, const FrameSet& set, RunId server_run, OdomFrames* odom);
PublicMoving copy_moving(const Map& map, const std::vector<MovingObject>& objects);
PublicTracks copy_tracks(const Map& map, const FrameSet& set);
// The corrected way of each camera in its map: the last seconds, and what is before at even intervals.
PublicPaths copy_paths(const Map& map);

// Copies the points that rest, some at a time, so that no frame set waits for a large map.
class CloudCopy {
 public:
  bool under_way() const { return cloud_ != nullptr; }
  void begin(const Map& map);
  void give_up() { cloud_.reset(); }  // the map was moved: what is there does not fit what is to come
  // The cloud, once all points are in it.
  std::shared_ptr<PublicCloud> go_on(const Map& map, std::size_t most);

 private:
  std::shared_ptr<PublicCloud> cloud_;
  PointId last_;
};

}  // namespace coslam
