// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/places/described_image.h"

#include <algorithm>
#include <utility>

#include "server/estimator/map/lens_step.h"

namespace coslam {
namespace {

constexpr double kPatience_s = 5;  // agents leave out what waited for half as long
constexpr std::size_t kMost = 4;   // of a camera: agents describe no image before the last one is under way

}  // namespace

DescribedImage newest_image(const MapCamera& camera) {
  DescribedImage out{camera, camera.frames.back().set, {}, {}};
  for (const auto& [id, track] : camera.tracks) {
    out.pixels.emplace_hint(out.pixels.end(), id, track.seen.back().undistorted_px);
    if (track.bound()) out.points.emplace_hint(out.points.end(), id, track.point);
  }
  return out;
}

void AwaitedDescriptors::await(PlaceRecognitionEdit& edit, const CameraFrame& frame) {
  const Map& map = edit.map();
  auto& awaited = awaited_[frame.camera];
  const auto too_old = [&](const Awaited& a) { return a.set.value + map.sets_in(kPatience_s) < map.now().value; };
  while (!awaited.empty() && (awaited.size() > kMost || too_old(awaited.front()))) {
    const SetId set = awaited.front().set;
    if (!map.is_key_frame(set)) edit.forget_view(set, frame.camera);
    awaited.pop_front();
  }
  if (frame.frame.descriptors_sent != DescriptorsSent::kLater) return;
  const MapCamera& camera = map.camera(frame.camera);
  DescribedImage image = newest_image(camera);
  edit.add_key_image(image.set, camera.id);
  awaited.push_back({frame.frame.frame, image.set, camera.lens, std::move(image.pixels)});
}

DescribedImage AwaitedDescriptors::image_of(const Map& map, const CameraFrame& frame) const {
  const MapCamera& camera = map.camera(frame.camera);
  const auto of_camera = awaited_.find(frame.camera);
  if (of_camera == awaited_.end()) return newest_image(camera);
  const auto image = std::ranges::find(of_camera->second, frame.descriptors->frame, &Awaited::frame);
  if (image == of_camera->second.end()) return newest_image(camera);
  const FramePose* f = camera.frame_at(image->set);
  const bool of_this_run = image->set >= camera.run_since;
  if (!of_this_run || f == nullptr || !f->valid() || f->map != camera.map) return newest_image(camera);
  DescribedImage out{camera, image->set, image->pixels, {}};
  const LensStep step(camera.model, image->lens, camera.lens);
  for (auto& [track, px] : out.pixels) step.move(&px);
  for (const MapPoint* p : map.points_observed_in({{image->set, camera.id}})) {
    for (const KeyObservation& o : p->key_observations) {
      if (o.set == image->set && o.camera == camera.id && p->map == camera.map) out.points[o.track] = p->id;
    }
  }
  return out;
}

void AwaitedDescriptors::came(const CameraFrame& frame) {
  std::erase_if(awaited_[frame.camera], [&](const Awaited& a) { return a.frame == frame.descriptors->frame; });
}

}  // namespace coslam
