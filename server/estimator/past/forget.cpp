// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/past/forget.h"

#include <algorithm>
#include <span>

#include "common/geometry/robust.h"
#include "server/estimator/adjust/final_poses.h"
#include "server/estimator/map/sighting.h"
#include "server/estimator/solve/bundle.h"

namespace coslam {
namespace {

constexpr std::size_t kMostAlike = 2;  // images of one place

// Distances of the points that an image observes.
std::vector<double> depths_of(const Map& map, const ImageKey& image, const FramePose& frame) {
  std::vector<double> depths;
  for (const MapPoint* p : map.points_observed_in({image})) {
    const bool seen = p->map == frame.map && std::ranges::any_of(p->key_observations, [&](const KeyObservation& o) {
                        return o.set == image.first && o.camera == image.second;
                      });
    if (seen) depths.push_back((p->position - frame.cam_from_world.center()).norm());
  }
  return depths;
}

const FramePose* frame_of(const Map& map, const ImageKey& image) {
  return map.camera(image.second).frame_at(image.first);
}

// The first and the last with a pose of each piece in one map.
std::set<SetId> ends_of_pieces(std::span<const FramePose> frames) {
  std::set<SetId> ends;
  const FramePose* last = nullptr;
  for (const FramePose& f : frames) {
    if (!f.valid()) continue;
    if (last == nullptr || last->map != f.map) {
      if (last != nullptr) ends.insert(last->set);
      ends.insert(f.set);
    }
    last = &f;
  }
  if (last != nullptr) ends.insert(last->set);
  return ends;
}

}  // namespace

PastPart Forget::run(ForgetEdit& edit, HeldFrames held) {
  const Map& map = edit.map();
  PastPart past;
  const std::uint32_t whole = map.sets_in(config.whole_s);
  if (map.now().value <= whole) return past;
  cutoff_ = std::max(cutoff_, SetId(map.now().value - whole));
  for (std::size_t c = archived_from_.size(); c < map.cameras().size(); ++c)
    archived_from_.push_back(map.cameras()[c].past.until);
  const std::set<ImageKey> holds(held.frames.begin(), held.frames.end());
  judge_images(edit, holds, &past.views);
  take_places(edit, &past);
  take_frames(edit, holds, &past);
  remove_points(edit);
  return past;
}

// No more at once than a few instants have: a map that was loaded may be all past.
void Forget::judge_images(ForgetEdit& edit, const std::set<ImageKey>& held, std::vector<ImageKey>* dropped) {
  constexpr std::size_t kMostAtOnce = 64;
  const Map& map = edit.map();
  if (judged_ == cutoff_) return;
  std::set<ImageKey> images;
  const auto& keys = map.key_frames();
  for (auto k = std::ranges::lower_bound(keys, judged_, {}, &KeyFrame::set);
       k != keys.end() && k->set < cutoff_ && images.size() < kMostAtOnce; ++k) {
    for (const MapCamera& c : map.cameras()) images.emplace(k->set, c.id);
  }
  const SetId until = images.size() < kMostAtOnce ? cutoff_ : SetId(images.rbegin()->first.value + 1);
  const auto& looks = map.key_images();
  images.insert(looks.lower_bound({judged_, CameraId(0)}), looks.lower_bound({until, CameraId(0)}));
  for (const ImageKey& image : images) judge_image(edit, image, held, dropped);
  judged_ = until;
}

std::vector<ImageKey> Forget::alike(const Map& map, const ImageKey& image, double depth) const {
  const FramePose& frame = *frame_of(map, image);
  std::vector<ImageKey> out;
  for (const ImageKey& other : kept_images_) {
    const FramePose* f = frame_of(map, other);
    if (f == nullptr || f->map != frame.map || other.first == image.first) continue;
    const double apart = (f->cam_from_world.center() - frame.cam_from_world.center()).norm();
    const double turn_rad = f->cam_from_world.rotation.angularDistance(frame.cam_from_world.rotation);
    if (apart < config.near_share * depth && turn_rad < config.near_rad) out.push_back(other);
  }
  return out;
}

void Forget::judge_image(ForgetEdit& edit, const ImageKey& image, const std::set<ImageKey>& held,
                         std::vector<ImageKey>* dropped) {
  const Map& map = edit.map();
  const FramePose* frame = frame_of(map, image);
  std::vector<double> depths =
      frame != nullptr && frame->valid() ? depths_of(map, image, *frame) : std::vector<double>();
  if (std::ssize(depths) < kLeastPointsOfPose) {
    drop_image(edit, image, held, dropped);
    return;
  }
  const auto has_looks = [&](const ImageKey& i) { return map.key_images().contains(i); };
  const bool looks = has_looks(image);
  const std::vector<ImageKey> all = alike(map, image, upper_median(depths));
  std::set<SetId> instants;
  for (const ImageKey& other : all) {
    if (!looks || has_looks(other)) instants.insert(other.first);
  }
  if (instants.size() < kMostAlike) {
    kept_images_.push_back(image);
    return;
  }
  if (!looks) {
    drop_image(edit, image, held, dropped);
    return;
  }
  for (const ImageKey& other : all) {
    if (other.first != *instants.begin()) drop_image(edit, other, held, dropped);
  }
  kept_images_.push_back(image);
}

void Forget::drop_image(ForgetEdit& edit, const ImageKey& image, const std::set<ImageKey>& held,
                        std::vector<ImageKey>* dropped) {
  edit.forget_view(image.first, image.second);
  std::erase(kept_images_, image);
  dropped->push_back(image);
  const MapCamera& camera = edit.map().camera(image.second);
  const bool archived_here = image.first >= archived_from_[image.second.value] && image.first < camera.past.until;
  if (archived_here && !own_anchors_.contains(image) && !held.contains(image)) edit.forget_frame(camera, image.first);
}

// One camera at a time, the one that is farthest behind: the work is spread over the frame sets.
void Forget::take_frames(ForgetEdit& edit, const std::set<ImageKey>& held, PastPart* past) {
  const Map& map = edit.map();
  const auto& cameras = map.cameras();
  const auto behind = std::ranges::min_element(cameras, {}, [](const MapCamera& c) { return c.past.until; });
  const std::uint32_t block = map.sets_in(config.block_s);
  const SetId limit = judged_;  // what is not judged may have to stay
  if (behind == cameras.end() || behind->past.until.value + block > limit.value) return;
  const MapCamera& camera = *behind;
  const std::span<const FramePose> present = camera.present_frames();
  const auto begin = present.begin();
  auto end = std::ranges::lower_bound(present, limit, {}, &FramePose::set);
  // No more at once than usual, as when a map of a program that forgot nothing is loaded.
  if (end - begin > 2 * static_cast<std::ptrdiff_t>(block)) end = begin + 2 * static_cast<std::ptrdiff_t>(block);
  const SetId from = camera.past.until;
  const SetId before = end == present.end() || end->set > limit ? limit : end->set;
  refine_final_poses(edit, camera, from, before);
  std::set<SetId> stays = ends_of_pieces({begin, end});
  for (const SetId set : stays) own_anchors_.emplace(set, camera.id);
  for (const auto& [set, camera_id] : kept_images_) {
    if (camera_id == camera.id && set >= from) stays.insert(set);
  }
  for (const auto& [set, camera_id] : held) {
    if (camera_id == camera.id) stays.insert(set);
  }
  const ArchivedPlace put = put_down_now(map);
  std::vector<FramePose> frames = edit.take_frames(camera, before, stays);
  if (!frames.empty()) past->frames.push_back({put, camera.id, std::move(frames)});
}

// While the frames that saw them are in memory.
void Forget::take_places(ForgetEdit& edit, PastPart* past) {
  constexpr double kPeriod_s = 1;
  const Map& map = edit.map();
  const SetId before(cutoff_.value + map.sets_in(2 * config.block_s));
  if (before.value < placed_.value + map.sets_in(kPeriod_s)) return;
  placed_ = before;
  edit.forget_seen(cutoff_);
  PastPlaces out{put_down_now(map), {}};
  for (const auto& [id, sample] : edit.take_motions(before)) {
    const FramePose* frame = nullptr;
    CameraId camera;
    for (const Sighting& s : sample.seen) {
      frame = map.camera(s.camera).frame_at(sample.set);
      camera = s.camera;
      if (frame != nullptr && frame->valid()) break;
    }
    if (frame == nullptr || !frame->valid()) continue;
    const auto at = position_of(map, frame->map, sample);
    if (!at) continue;
    const Eigen::Matrix3d r = frame->cam_from_world.rotation.toRotationMatrix();
    out.places.push_back({sample.t_ns, id, sample.set, camera, frame->map, frame->cam_from_world * at->at.position,
                          r * at->at.covariance * r.transpose(), at->views});
  }
  std::ranges::stable_sort(out.places, {}, &PastPlace::t_ns);
  if (!out.places.empty()) past->places = std::move(out);
}

void Forget::remove_points(ForgetEdit& edit) {
  const Map& map = edit.map();
  if (cutoff_.value < swept_.value + map.sets_in(config.block_s)) return;
  const std::uint32_t later = map.sets_in(4 * config.block_s);  // until its frames have gone
  std::vector<const MapPoint*> useless;
  for (const auto& [id, p] : map.points()) {
    if (!p.bound.empty() || p.last_seen >= cutoff_) continue;
    if (p.key_observations.size() < 2) {
      useless.push_back(&p);
    } else if (p.last_seen.value + later >= swept_.value && p.last_seen.value + later < cutoff_.value) {
      edit.forget_patches(p);
    }
  }
  for (const MapPoint* p : useless) {
    edit.remove_point(*p, Why::kShownByOthers, {static_cast<double>(p->key_observations.size()), 0});
  }
  swept_ = cutoff_;
}

}  // namespace coslam
