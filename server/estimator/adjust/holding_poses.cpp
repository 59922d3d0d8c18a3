// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/adjust/holding_poses.h"

#include <algorithm>
#include <cstdint>
#include <map>

#include "server/estimator/solve/bundle.h"

namespace coslam {
namespace {

// Counts by pose: of each camera's at the sets of a list.
using Counts = std::vector<int>;  // [set * cameras + camera]

// Older poses that see points of the window, by how many, of all cameras and of each one's alone.
struct SharedPoints {
  std::size_t cameras = 0;
  std::vector<SetId> sets;  // as they were met
  Counts all;
  std::map<CameraId, Counts> of_camera;
};

SharedPoints shared_with_window(const Map& map, MapId map_id, SetId first) {
  SharedPoints shared{.cameras = map.cameras().size()};
  std::vector<int> place_of(first.value, -1);  // of a set in the list
  const auto place = [&](SetId set) {
    int& at = place_of[set.value];
    if (at < 0) {
      at = static_cast<int>(shared.sets.size());
      shared.sets.push_back(set);
      shared.all.resize(shared.sets.size() * shared.cameras);
    }
    return static_cast<std::size_t>(at);
  };
  std::vector<Counts*> counts;
  for (const MapPoint* point : map.points_observed_since(first)) {
    const MapPoint& p = *point;
    if (p.map != map_id || p.key_observations.empty() || p.key_observations.back().set < first) continue;
    counts.clear();
    for (const KeyObservation& o : p.key_observations) {
      if (o.set < first) continue;
      Counts* of_camera = &shared.of_camera[o.camera];
      if (std::ranges::find(counts, of_camera) == counts.end()) counts.push_back(of_camera);
    }
    for (const KeyObservation& o : p.key_observations) {
      if (o.set >= first) break;
      const std::size_t pose = place(o.set) * shared.cameras + o.camera.value;
      ++shared.all[pose];
      for (Counts* c : counts) {
        if (c->size() <= pose) c->resize(shared.all.size());
        ++(*c)[pose];
      }
    }
  }
  return shared;
}

// Those that share enough to hold, most first.
Poses by_shared_points(const SharedPoints& shared, const Counts& counts) {
  std::vector<std::pair<int, ImageKey>> order;
  for (std::size_t pose = 0; pose < counts.size(); ++pose) {
    if (counts[pose] < kLeastPointsOfPose) continue;
    const CameraId camera(static_cast<std::uint16_t>(pose % shared.cameras));
    order.emplace_back(-counts[pose], std::pair(shared.sets[pose / shared.cameras], camera));
  }
  std::ranges::sort(order);
  Poses out;
  out.reserve(order.size());
  for (const auto& [n, key] : order) out.push_back(key);
  return out;
}

}  // namespace

Poses holding_poses(const Map& map, MapId map_id, SetId first, std::size_t most) {
  constexpr std::size_t kOfEachCamera = 3;
  const SharedPoints shared = shared_with_window(map, map_id, first);
  Poses out = by_shared_points(shared, shared.all);
  out.resize(std::min(most, out.size()));
  for (const auto& [camera, counts] : shared.of_camera) {
    const Poses camera_poses = by_shared_points(shared, counts);
    for (std::size_t i = 0; i < std::min(kOfEachCamera, camera_poses.size()); ++i) {
      if (std::ranges::find(out, camera_poses[i]) == out.end()) out.push_back(camera_poses[i]);
    }
  }
  return out;
}

}  // namespace coslam
