// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/stages/key_frame.h"

#include <algorithm>
#include <cmath>

namespace coslam {
namespace {

struct SinceLast {
  int then = 0, still = 0;  // points seen at the last key frame, and of those seen now
  double median_turn_rad = 0;
};

SinceLast since_last(const Map& map, const MapCamera& camera, SetId last) {
  SinceLast out;
  const FramePose* then = camera.frame_at(last);
  const FramePose& now = camera.frames.back();
  if (then == nullptr || then->map != now.map || !now.valid()) return out;
  std::vector<double> turns;
  for (const auto& [id, p] : map.points()) {
    const auto seen = std::find_if(p.key_observations.rbegin(), p.key_observations.rend(),
                                   [&](const KeyObservation& o) { return o.set <= last; });
    bool had = false;
    for (auto o = seen; o != p.key_observations.rend() && o->set == last; ++o) had |= o->camera == camera.id;
    if (!had) continue;
    ++out.then;
    const bool has =
        std::any_of(p.bound.begin(), p.bound.end(), [&](const BoundTrack& b) { return b.camera == camera.id; });
    if (!has) continue;
    ++out.still;
    const Eigen::Vector3d a = (p.position - then->cam_from_world.center()).normalized();
    const Eigen::Vector3d b = (p.position - now.cam_from_world.center()).normalized();
    turns.push_back(std::acos(std::clamp(a.dot(b), -1.0, 1.0)));
  }
  if (!turns.empty()) {
    const auto middle = turns.begin() + static_cast<std::ptrdiff_t>(turns.size() / 2);
    std::nth_element(turns.begin(), middle, turns.end());
    out.median_turn_rad = *middle;
  }
  return out;
}

}  // namespace

bool decide_key_frame(Map& map, const FrameSet& set, const KeyFrameConfig& config) {
  if (map.points().empty()) return false;
  if (!map.key_frames().empty()) {
    const SetId last = map.key_frames().back().set;
    const auto gap = set.id.value - last.value;
    if (gap < static_cast<std::uint32_t>(config.min_sets)) return false;
    bool wanted = false;
    for (const CameraFrame& cf : set.frames) {
      const MapCamera& camera = map.camera(cf.camera);
      if (!camera.frames.back().valid()) continue;
      const SinceLast s = since_last(map, camera, last);
      if (s.then == 0 || s.still < (1.0 - config.drop) * s.then) wanted = true;
      if (s.median_turn_rad > 2 * config.moved_rad) wanted = true;
      if (gap >= static_cast<std::uint32_t>(config.max_sets) && s.median_turn_rad > config.moved_rad) wanted = true;
    }
    if (!wanted) return false;
  }
  map.add_key_frame(set.id);
  return true;
}

}  // namespace coslam
