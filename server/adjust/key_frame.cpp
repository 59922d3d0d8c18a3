// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/adjust/key_frame.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/robust.h"

namespace coslam {
namespace {

struct SinceLast {
  int then = 0, still = 0;  // points seen at the last key frame, and of those seen now
  double median_turn_rad = 0;
};

// Of every camera.
std::vector<SinceLast> since_last(const Map& map, SetId last) {
  std::vector<SinceLast> out(map.cameras().size());
  std::vector<std::vector<double>> turns(map.cameras().size());
  std::vector<const FramePose*> then;  // null where there is nothing to compare
  for (const MapCamera& c : map.cameras()) {
    const FramePose* f = c.frame_at(last);
    then.push_back(f != nullptr && f->valid() && f->map == c.frames.back().map ? f : nullptr);
  }
  for (const MapPoint* point : map.points_observed_at({last})) {
    const MapPoint& p = *point;
    for (std::size_t i = p.key_observations.size(); i-- > 0 && p.key_observations[i].set >= last;) {
      const KeyObservation& o = p.key_observations[i];
      if (o.set != last || then[o.camera.value] == nullptr) continue;
      SinceLast& s = out[o.camera.value];
      ++s.then;
      if (!seen_by(p, o.camera)) continue;
      ++s.still;
      const FramePose& now = map.camera(o.camera).frames.back();
      const Eigen::Vector3d a = (p.position - then[o.camera.value]->cam_from_world.center()).normalized();
      const Eigen::Vector3d b = (p.position - now.cam_from_world.center()).normalized();
      turns[o.camera.value].push_back(std::acos(std::clamp(a.dot(b), -1.0, 1.0)));
    }
  }
  for (std::size_t c = 0; c < out.size(); ++c) {
    out[c].median_turn_rad = upper_median(turns[c]);
  }
  return out;
}

}  // namespace

bool decide_key_frame(MapEdit& edit, const FrameSet& set, const KeyFrameConfig& config) {
  const Map& map = edit.map();
  if (map.points().empty()) return false;
  if (!map.key_frames().empty()) {
    const SetId last = map.key_frames().back().set;
    const auto gap = set.id.value - last.value;
    if (gap < kLeastFrames) return false;
    bool wanted = false;
    const std::vector<SinceLast> since = since_last(map, last);
    for (const CameraFrame& cf : set.frames) {
      const MapCamera& camera = map.camera(cf.camera);
      if (!camera.frames.back().valid()) continue;
      const SinceLast& s = since[camera.id.value];
      if (s.then == 0 || s.still < (1.0 - config.drop) * s.then) wanted = true;
      if (s.median_turn_rad > 2 * map.config().new_view_rad) wanted = true;
      if (gap >= map.sets_in(config.max_s) && s.median_turn_rad > map.config().new_view_rad) wanted = true;
    }
    if (!wanted) return false;
  }
  edit.add_key_frame(set.id);
  return true;
}

}  // namespace coslam
