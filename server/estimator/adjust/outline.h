// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "server/estimator/map/map.h"

// Which key frames of a map an adjustment is of, where it is not of all.
namespace coslam {

constexpr int kMostApart = 3;  // key frames of an outline: neighbours have to see the same points

// Key frames with so many poses each, ascending.
struct KeyPoses {
  std::vector<SetId> sets;
  std::vector<int> poses;

  int sum() const;
};

// Nothing unless it takes part in adjustments of this map.
const FramePose* pose_to_adjust(const Map& map, MapId of, SetId set, CameraId camera);
// All with a pose that takes part.
KeyPoses key_poses(const Map& map, MapId of);
// Some of them, evenly, the first and the newest among them.
std::vector<SetId> outline_of(const KeyPoses& keys, int most_poses);
// Those since a set, as long as their poses are no more than that together: the newest.
KeyPoses newest_of(const KeyPoses& keys, SetId since, int most_poses);

}  // namespace coslam
