// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/adjust/holding_poses.h"

#include <algorithm>
#include <map>

namespace coslam {
namespace {

// Older poses that see points of the window, by how many, of all cameras and of each one's alone.
struct SharedPoints {
  PoseIndex all;
  std::map<CameraId, PoseIndex> of_camera;
};

SharedPoints shared_with_window(const Map& map, MapId of, SetId first) {
  SharedPoints shared;
  std::vector<CameraId> cameras;
  for (const MapPoint* point : map.points_observed_since(first)) {
    const MapPoint& p = *point;
    if (p.map != of || p.key_observations.empty() || p.key_observations.back().set < first) continue;
    cameras.clear();
    for (const KeyObservation& o : p.key_observations) {
      if (o.set >= first && std::ranges::find(cameras, o.camera) == cameras.end()) cameras.push_back(o.camera);
    }
    for (const KeyObservation& o : p.key_observations) {
      if (o.set >= first) break;
      ++shared.all[{o.set, o.camera}];
      for (const CameraId c : cameras) ++shared.of_camera[c][{o.set, o.camera}];
    }
  }
  return shared;
}

// Those that share enough to hold, most first.
Poses by_shared_points(const PoseIndex& shared) {
  constexpr int kLeast = 8;
  std::vector<std::pair<int, std::pair<SetId, CameraId>>> order;
  for (const auto& [key, n] : shared) {
    if (n >= kLeast) order.emplace_back(-n, key);
  }
  std::ranges::sort(order);
  Poses out;
  out.reserve(order.size());
  for (const auto& [n, key] : order) out.push_back(key);
  return out;
}

}  // namespace

Poses holding_poses(const Map& map, MapId of, SetId first, std::size_t most) {
  constexpr std::size_t kOfEachCamera = 3;
  const SharedPoints shared = shared_with_window(map, of, first);
  Poses out = by_shared_points(shared.all);
  out.resize(std::min(most, out.size()));
  for (const auto& [camera, with] : shared.of_camera) {
    const Poses own = by_shared_points(with);
    for (std::size_t i = 0; i < std::min(kOfEachCamera, own.size()); ++i) {
      if (std::ranges::find(out, own[i]) == out.end()) out.push_back(own[i]);
    }
  }
  return out;
}

}  // namespace coslam
