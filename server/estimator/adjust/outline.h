// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "server/estimator/map/map.h"

// Selection of a map's key frames for adjustments that do not take all.
namespace coslam {

constexpr int kMostApart = 3;  // Largest step between key frames of an outline: neighbours have to see the same points.

// Key frames with their number of poses, sorted.
struct KeyPoses {
  std::vector<SetId> sets;
  std::vector<int> poses;

  int sum() const;
};

// Returns the pose of a camera at a key frame if it takes part in adjustments of this map, else null.
const FramePose* pose_to_adjust(const Map& map, MapId map_id, SetId set, CameraId camera);
// Returns all key frames with a pose that takes part.
KeyPoses key_poses(const Map& map, MapId map_id);
// Selects key frames evenly, the first and the newest among them.
std::vector<SetId> outline_of(const KeyPoses& keys, int most_poses);
// Selects the newest key frames, not before first_set, with at most most_poses poses together.
KeyPoses newest_of(const KeyPoses& keys, SetId first_set, int most_poses);

}  // namespace coslam
