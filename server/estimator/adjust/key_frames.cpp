// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/adjust/key_frames.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "common/geometry/robust.h"
#include "server/estimator/adjust/lens.h"

namespace coslam {
namespace {

struct SinceLast {
  const FramePose* last_frame = nullptr;  // its last key frame; null where there is nothing to compare
  int seen = 0, still = 0;                // points seen then, and of those seen now
  double median_turn_rad = 0;
};

// The newest key frame that this camera took part in, of those at which it may still see the same.
const FramePose* last_of(const Map& map, const MapCamera& camera) {
  constexpr std::size_t kMost = 16;  // key frames
  const auto& keys = map.key_frames();
  for (std::size_t i = keys.size(); i > 0 && keys.size() - i < kMost; --i) {
    const SetId set = keys[i - 1].set;
    const FramePose* f = camera.frame_at(set);
    if (f == nullptr || !f->valid() || f->map != camera.frames.back().map) return nullptr;
    if (!map.skipped_key_images().contains({set, camera.id})) return f;
  }
  return nullptr;
}

// Of every camera.
std::vector<SinceLast> since_last(const Map& map) {
  std::vector<SinceLast> out(map.cameras().size());
  std::vector<std::vector<double>> turns(map.cameras().size());
  std::vector<ImageKey> images;
  for (const MapCamera& c : map.cameras()) {
    SinceLast& s = out[c.id.value];
    if (!c.frames.empty()) s.last_frame = last_of(map, c);
    if (s.last_frame != nullptr) images.emplace_back(s.last_frame->set, c.id);
  }
  if (images.empty()) return out;
  const SetId first = std::ranges::min(images).first;
  for (const MapPoint* point : map.points_observed_in(images)) {
    const MapPoint& p = *point;
    for (std::size_t i = p.key_observations.size(); i-- > 0 && p.key_observations[i].set >= first;) {
      const KeyObservation& o = p.key_observations[i];
      SinceLast& s = out[o.camera.value];
      if (s.last_frame == nullptr || o.set != s.last_frame->set) continue;
      ++s.seen;
      if (!seen_by(p, o.camera)) continue;
      ++s.still;
      const FramePose& now = map.camera(o.camera).frames.back();
      const Eigen::Vector3d a = (p.position - s.last_frame->cam_from_world.center()).normalized();
      const Eigen::Vector3d b = (p.position - now.cam_from_world.center()).normalized();
      turns[o.camera.value].push_back(std::acos(std::clamp(a.dot(b), -1.0, 1.0)));
    }
  }
  for (std::size_t c = 0; c < out.size(); ++c) {
    out[c].median_turn_rad = upper_median(turns[c]);
  }
  return out;
}

bool needs_key_frame(const Map& map, const SinceLast& s, const KeyFramesConfig& config) {
  if (s.last_frame == nullptr || s.seen == 0 || s.still < (1.0 - config.drop) * s.seen) return true;
  if (s.median_turn_rad > 2 * map.config().new_view_rad) return true;
  const bool long_ago = map.now().value - s.last_frame->set.value >= map.sets_in(config.max_s);
  return long_ago && s.median_turn_rad > map.config().new_view_rad;
}

std::size_t two_windows(const BundleAdjustmentConfig& refine) { return 2 * static_cast<std::size_t>(refine.window); }

}  // namespace

bool decide_key_frame(KeyFramesEdit& edit, const FrameSet& set, const KeyFramesConfig& config) {
  constexpr double kSoonest_s = 0.3;  // after the last one
  constexpr std::size_t kFew = 4;     // cameras, which all take part: it costs little, and ties them together
  const Map& map = edit.map();
  if (map.points().empty()) return false;
  std::vector<CameraId> spared;
  if (!map.key_frames().empty()) {
    // What little changed from image to image has nothing to add; where images are seldom each shows another part.
    const auto least = std::min<std::uint32_t>(kLeastFrames, map.sets_in(kSoonest_s));
    if (set.id.value - map.key_frames().back().set.value < least) return false;
    bool wanted = false;
    const std::vector<SinceLast> changes = since_last(map);
    for (const CameraFrame& cf : set.frames) {
      const MapCamera& camera = map.camera(cf.camera);
      if (!camera.frames.back().valid()) continue;
      const bool needs = needs_key_frame(map, changes[camera.id.value], config);
      wanted = wanted || needs;
      if (!needs && set.frames.size() > kFew) spared.push_back(camera.id);
    }
    if (!wanted) return false;
  }
  edit.add_key_frame(set.id, spared);
  return true;
}

KeyFramesReport KeyFrames::run(KeyFramesEdit& edit, const FrameSet& set, const BundleAdjustmentReport& taken,
                               const PlaceRecognitionReport& met, const BundleAdjustmentConfig& refine,
                               Workers& workers) {
  if (taken.taken) in_flight_ = false;
  // One that a change of the map overtook is planned again.
  const bool done = taken.taken && taken.extent == RefineExtent::kOutline && (taken.report.applied || !taken.usable);
  if (done && taken.map == outline_) outline_ = MapId();
  if (taken.report.lens_step2 > kOnItsWay2) due_[taken.map] = 0;
  if (met.to_adjust != MapId()) {
    outline_since_ = met.to_adjust == outline_ ? std::min(outline_since_, met.adjust_since) : met.adjust_since;
    outline_ = met.to_adjust;
  }
  const bool key_frame = decide_key_frame(edit, set, config);
  return {key_frame, plan_job(edit.map(), key_frame, refine, workers)};
}

bool KeyFrames::plan_job(const Map& map, bool key_frame, const BundleAdjustmentConfig& refine, Workers& workers) {
  const bool outline = outline_ != MapId();
  if (!refine.enabled || in_flight_ || !(key_frame || outline)) return false;
  std::vector<MapId> maps;
  for (const MapCamera& c : map.cameras()) {
    if (c.map != MapId() && std::find(maps.begin(), maps.end(), c.map) == maps.end()) maps.push_back(c.map);
  }
  if (maps.empty()) return false;
  const MapId map_id = outline ? outline_ : maps[static_cast<std::size_t>(plans_) % maps.size()];
  if (outline) {
    planned_ = plan_outline_since(map, map_id, outline_since_, refine, workers);
  } else if (outline_is_due(map, map_id, refine)) {
    planned_ = plan_outline_since(map, map_id, SetId(), refine, workers);
    // Until then the windows reach as far, and hold the scale better.
    if (planned_) planned_->for_lenses = map.key_frames().size() < two_windows(refine);
    const bool breathes = std::ranges::any_of(map.cameras(), [](const MapCamera& c) { return c.breathing > 0; });
    if (planned_ && (breathes || zooms_are_due(map, map_id, refine))) planned_->zooms = true;
  } else {
    planned_ = plan_refine(map, map_id, RefineExtent::kWindow, refine, workers);
  }
  if (planned_) {
    ++plans_;
  } else if (outline) {
    outline_ = MapId();  // too little to adjust, or part of another map by now
  }
  return planned_.has_value();
}

// From more key frames than a window holds, until an outline leaves out most.
bool KeyFrames::outline_is_due(const Map& map, MapId map_id, const BundleAdjustmentConfig& refine) {
  constexpr std::size_t kPart = 4;
  const std::size_t keys = map.key_frames().size();
  std::size_t& due = due_.try_emplace(map_id, refine.window).first->second;
  if (keys < due || keys > static_cast<std::size_t>(refine.outline_poses)) return false;
  due = keys + std::max<std::size_t>(1, keys / kPart);
  return true;
}

bool KeyFrames::zooms_are_due(const Map& map, MapId map_id, const BundleAdjustmentConfig& refine) {
  const std::size_t keys = map.key_frames().size();
  std::size_t& due = zooms_due_.try_emplace(map_id, two_windows(refine)).first->second;
  if (keys < due) return false;
  due = 2 * keys;
  return true;
}

std::optional<RefineJob> KeyFrames::take_job() {
  if (!planned_) return std::nullopt;
  in_flight_ = true;
  return std::exchange(planned_, std::nullopt);
}

}  // namespace coslam
