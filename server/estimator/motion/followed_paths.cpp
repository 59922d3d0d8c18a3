// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/motion/followed_paths.h"

#include <algorithm>

#include "server/estimator/map/sighting.h"

namespace coslam {

std::optional<FollowedPaths::Anchor> FollowedPaths::anchor_of(const Map& map, MapId in, const MotionSample& sample,
                                                              const Eigen::Vector3d& position) {
  Anchor a;
  const FramePose* first = nullptr;
  for (const Sighting& s : sample.seen) {
    const FramePose* f = map.camera(s.camera).frame_at(sample.set);
    if (f == nullptr || f->map != in || (first != nullptr && s.camera == a.first)) continue;
    if (first == nullptr) {
      first = f;
      a.first = s.camera;
      a.in_first = f->cam_from_world * position;
      continue;
    }
    a.second = s.camera;
    a.baseline = (f->cam_from_world.center() - first->cam_from_world.center()).norm();
    if (a.baseline > 0) return a;
  }
  return std::nullopt;
}

bool FollowedPaths::follow(const Map& map, MapId in, Anchor* a, PathSample* sample) {
  const FramePose* first = map.camera(a->first).frame_at(sample->set);
  const FramePose* second = map.camera(a->second).frame_at(sample->set);
  if (first == nullptr || second == nullptr || first->map != in || second->map != in) return false;
  const double baseline = (second->cam_from_world.center() - first->cam_from_world.center()).norm();
  a->in_first *= baseline / a->baseline;
  a->baseline = baseline;
  sample->position = first->cam_from_world.inverse() * a->in_first;
  return baseline > 0;
}

void FollowedPaths::extend(const Map& map, const MapPoint& point, TimeNs since_ns, Path* path) {
  const auto motion = map.motions().find(point.id);
  if (motion == map.motions().end()) return;
  const std::vector<MotionSample>& seen = motion->second;
  auto next = seen.end();
  while (next != seen.begin() && std::prev(next)->t_ns >= since_ns &&
         (path->samples.empty() || std::prev(next)->set > path->samples.back().set)) {
    --next;
  }
  for (; next != seen.end(); ++next) {
    std::optional<Eigen::Vector3d> position;
    if (next->set == point.last_seen) {
      position = point.position;
    } else if (const auto at = position_of(map, point.map, *next)) {
      position = at->at.position;
    }
    const auto anchor = position ? anchor_of(map, point.map, *next, *position) : std::nullopt;
    if (!anchor) continue;
    path->samples.push_back({next->set, next->t_ns, *position});
    path->anchors.push_back(*anchor);
  }
}

void FollowedPaths::update(const Map& map, TimeNs since_ns) {
  const bool moved = map.epoch() != epoch_;
  epoch_ = map.epoch();
  std::erase_if(paths_, [&](const auto& entry) {
    const MapPoint* p = map.find(entry.first);
    return p == nullptr || !p->moves();
  });
  for (const MapPoint* moving : map.moving_points()) {
    const MapPoint& point = *moving;
    Path& path = paths_[point.id];
    Path next_path;
    for (std::size_t i = 0; i < path.samples.size(); ++i) {
      PathSample& sample = path.samples[i];
      if (sample.t_ns < since_ns || (moved && !follow(map, point.map, &path.anchors[i], &sample))) continue;
      next_path.samples.push_back(sample);
      next_path.anchors.push_back(path.anchors[i]);
    }
    path = std::move(next_path);
    extend(map, point, since_ns, &path);
  }
}

}  // namespace coslam
