// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/associate/recall.h"

#include <algorithm>
#include <set>
#include <utility>

#include "server/estimator/associate/track_grid.h"

namespace coslam {
namespace {

constexpr int kLeast = 4;               // points that a key frame shares with what a camera sees
constexpr std::size_t kMostFrames = 4;  // of those that share most
constexpr std::size_t kBeside = 2;      // key frames before and after each

// Key frames long ago that saw what a camera follows, those that saw most of it first.
class SharedKeyFrames {
 public:
  explicit SharedKeyFrames(const Map& map)
      : map_(map), recent_since_(map.set_ago(map.config().recent_s)), shared_(recent_since_.value, 0) {}

  std::vector<SetId> sets_with(const MapCamera& camera) {
    std::vector<SetId> sets;
    for (const auto& [id, track] : camera.tracks) {
      const MapPoint* p = map_.find(track.point);
      if (p == nullptr || !p->proven()) continue;
      SetId counted = map_.now();  // once for all cameras that saw it then
      for (const KeyObservation& o : p->key_observations) {
        if (o.set >= recent_since_) break;
        if (o.set != counted && shared_[o.set.value]++ == 0) sets.push_back(o.set);
        counted = o.set;
      }
    }
    std::vector<std::pair<int, SetId>> order;
    for (const SetId s : sets) {
      const int n = std::exchange(shared_[s.value], 0);
      if (n >= kLeast) order.emplace_back(-n, s);
    }
    std::ranges::sort(order);
    std::vector<SetId> out;
    for (std::size_t i = 0; i < std::min(kMostFrames, order.size()); ++i) out.push_back(order[i].second);
    return out;
  }

 private:
  const Map& map_;
  SetId recent_since_;
  std::vector<int> shared_;  // points, by set; 0 between calls
};

}  // namespace

std::vector<const MapPoint*> points_of_earlier_visits(const Map& map, const std::vector<CameraId>& cameras) {
  std::set<SetId> sets;
  SharedKeyFrames shared(map);
  const auto& keys = map.key_frames();
  for (const CameraId id : cameras) {
    const MapCamera& camera = map.camera(id);
    if (!camera.frames.back().valid()) continue;
    for (const SetId s : shared.sets_with(camera)) {
      const auto at = static_cast<std::size_t>(std::ranges::lower_bound(keys, s, {}, &KeyFrame::set) - keys.begin());
      for (std::size_t k = at - std::min(at, kBeside); k < std::min(keys.size(), at + kBeside + 1); ++k) {
        sets.insert(keys[k].set);
      }
    }
  }
  std::vector<const MapPoint*> out = map.points_observed_at({sets.begin(), sets.end()});
  const SetId recent_since = map.set_ago(map.config().recent_s);
  std::erase_if(out, [&](const MapPoint* p) { return !p->proven() || p->last_seen >= recent_since; });
  return out;
}

std::vector<const MapPoint*> static_points_around(const Map& map, const std::vector<CameraId>& cameras) {
  std::vector<const MapPoint*> out = recent_static_points(map);
  const auto recent = static_cast<std::ptrdiff_t>(out.size());
  const std::vector<const MapPoint*> earlier = points_of_earlier_visits(map, cameras);
  out.insert(out.end(), earlier.begin(), earlier.end());
  std::ranges::inplace_merge(out, out.begin() + recent, {}, &MapPoint::id);
  return out;
}

}  // namespace coslam
