// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/map/past_pen.h"

#include <algorithm>

#include "common/base/check.h"

namespace coslam {
namespace {

bool before_set(const FramePose& f, SetId set) { return f.set < set; }

// A camera's frames of one block, as the report has them.
void count(const std::vector<FramePose>& block, PastFramesCount* past) {
  if (block.empty()) return;
  if (past->frames == 0) past->first_ns = block.front().capture_ns;
  past->frames += static_cast<int>(block.size());
  const FramePose* lost_from = nullptr;
  for (const FramePose& f : block) {
    if (f.valid()) ++past->placed[f.map];
    if (!f.valid() && lost_from == nullptr) lost_from = &f;
    if (f.valid() && lost_from != nullptr) past->lost.emplace_back(lost_from->capture_ns, f.capture_ns);
    if (f.valid()) lost_from = nullptr;
  }
  if (lost_from != nullptr) past->lost.emplace_back(lost_from->capture_ns, block.back().capture_ns);
}

}  // namespace

void PastPen::forget_view(SetId set, CameraId camera) {
  COSLAM_CHECK(set < map_.now_, "what is seen now is no past");
  map_.key_images_.erase({set, camera});
  map_.skipped_key_images_.erase({set, camera});
  if (const auto at = map_.observed_in_.find({set, camera}); at != map_.observed_in_.end()) {
    for (const PointId id : at->second) {
      MapPoint* p = mutable_point(id);
      if (p == nullptr) continue;
      std::erase_if(p->key_observations, [&](const auto& o) { return o.set == set && o.camera == camera; });
    }
    map_.observed_in_.erase(at);
  }
  const auto seen = map_.points_observed_at({set});
  const auto still = [&](const KeyObservation& o) { return o.set == set; };
  if (std::ranges::any_of(seen, [&](const MapPoint* p) { return std::ranges::any_of(p->key_observations, still); }))
    return;
  std::erase_if(map_.key_frames_, [&](const KeyFrame& k) { return k.set == set; });
}

void PastPen::forget_patches(const MapPoint& point) {
  auto& all = mutable_point(point).patches;
  if (all.empty()) return;
  const auto has_no_frame = [&](const PointPatch& p) { return map_.camera(p.camera).frame_at(p.set) == nullptr; };
  all.erase(std::remove_if(all.begin() + 1, all.end(), has_no_frame), all.end());
  all.shrink_to_fit();
}

void PastPen::forget_seen(SetId before) {
  for (MapCamera& c : map_.cameras_) {
    for (auto& [id, track] : c.tracks) {
      const auto first = std::ranges::lower_bound(track.seen, before, {}, &TrackPoint::set);
      if (first != track.seen.end()) track.seen.erase(track.seen.begin(), first);
    }
  }
}

std::vector<FramePose> PastPen::take_frames(const MapCamera& camera, SetId before, const std::set<SetId>& stays) {
  MapCamera& c = mutable_camera(camera);
  const auto first = std::lower_bound(c.frames.begin(), c.frames.end(), c.past.until, before_set);
  const auto last = std::lower_bound(first, c.frames.end(), before, before_set);
  std::vector<FramePose> block;
  block.reserve(static_cast<std::size_t>(last - first));
  for (auto f = first; f != last; ++f) {
    f->held = {};
    block.push_back(*f);
  }
  const auto new_end = std::remove_if(first, last, [&](const FramePose& f) { return !stays.contains(f.set); });
  c.frames.erase(new_end, last);
  count(block, &c.past);
  c.past.until = before;
  return block;
}

void PastPen::forget_frame(const MapCamera& camera, SetId set) {
  COSLAM_CHECK(set < camera.past.until, "only what was given out");
  std::erase_if(mutable_camera(camera).frames, [&](const FramePose& f) { return f.set == set; });
}

std::vector<std::pair<PointId, MotionSample>> PastPen::take_motions(SetId before) {
  std::vector<std::pair<PointId, MotionSample>> out;
  for (auto at = map_.motions_.begin(); at != map_.motions_.end();) {
    auto& [id, path] = *at;
    const auto stay =
        std::stable_partition(path.begin(), path.end(), [&](const MotionSample& s) { return s.set < before; });
    for (auto s = path.begin(); s != stay; ++s) out.emplace_back(id, std::move(*s));
    path.erase(path.begin(), stay);
    at = path.empty() ? map_.motions_.erase(at) : std::next(at);
  }
  return out;
}

}  // namespace coslam
