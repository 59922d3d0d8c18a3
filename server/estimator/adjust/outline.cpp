// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/adjust/outline.h"

#include <algorithm>
#include <numeric>

namespace coslam {
namespace {

int poses_to_adjust(const Map& map, MapId map_id, SetId set) {
  return static_cast<int>(std::ranges::count_if(
      map.cameras(), [&](const MapCamera& c) { return pose_to_adjust(map, map_id, set, c.id) != nullptr; }));
}

}  // namespace

int KeyPoses::sum() const { return std::accumulate(poses.begin(), poses.end(), 0); }

const FramePose* pose_to_adjust(const Map& map, MapId map_id, SetId set, CameraId camera) {
  const FramePose* f = map.camera(camera).frame_at(set);
  const bool takes_part = f != nullptr && f->map == map_id && !f->joint && map.keeps_observations_of(set, camera);
  return takes_part ? f : nullptr;
}

KeyPoses key_poses(const Map& map, MapId map_id) {
  KeyPoses out;
  for (const KeyFrame& k : map.key_frames()) {
    const int n = poses_to_adjust(map, map_id, k.set);
    if (n == 0) continue;
    out.sets.push_back(k.set);
    out.poses.push_back(n);
  }
  return out;
}

std::vector<SetId> outline_of(const KeyPoses& keys, int most_poses) {
  const int poses = keys.sum();
  if (poses <= most_poses) return keys.sets;
  const int apart = std::min(kMostApart, (poses + most_poses - 1) / most_poses);
  const std::size_t all = keys.sets.size(), count = std::max<std::size_t>(2, all / static_cast<std::size_t>(apart));
  std::vector<SetId> out;
  out.reserve(count);
  for (std::size_t i = 0; i < count; ++i) out.push_back(keys.sets[i * (all - 1) / (count - 1)]);
  return out;
}

KeyPoses newest_of(const KeyPoses& keys, SetId first_set, int most_poses) {
  std::size_t first = keys.sets.size();
  for (int sum = 0; first > 0 && keys.sets[first - 1] >= first_set; --first) {
    sum += keys.poses[first - 1];
    if (sum > most_poses) break;
  }
  const auto n = static_cast<std::ptrdiff_t>(first);
  return {{keys.sets.begin() + n, keys.sets.end()}, {keys.poses.begin() + n, keys.poses.end()}};
}

}  // namespace coslam
