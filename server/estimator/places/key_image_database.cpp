// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/places/key_image_database.h"

#include <algorithm>
#include <set>

#include "server/estimator/map/memory.h"
#include "server/estimator/places/locate.h"

namespace coslam {
void KeyImageDatabase::add(KeyImageEdit& edit, const DescribedImage& image, const DescriptorReply& reply) {
  if (reply.tracks.empty()) return;
  edit.add_key_image(image.set, image.camera.id);
  images_[index_.add(reply.descriptors)] = {image.set, image.camera.id, reply.tracks, reply.descriptors};
}

void KeyImageDatabase::forget(const std::vector<ImageKey>& views) {
  if (views.empty()) return;
  const std::set<ImageKey> forgotten(views.begin(), views.end());
  std::erase_if(images_, [&](const auto& entry) {
    const auto& [number, image] = entry;
    if (!forgotten.contains({image.set, image.camera})) return false;
    index_.remove(number, image.descriptors);
    if (number < saved_) forgotten_.push_back(number);
    return true;
  });
}

std::size_t KeyImageDatabase::bytes() const {
  std::size_t bytes = index_.bytes();
  for (const auto& [number, i] : images_) bytes += sizeof i + bytes_of(i.tracks) + bytes_of(i.descriptors);
  return bytes;
}

ExpectedPlace KeyImageDatabase::find_expected(const Map& map, const DescribedImage& image, const DescriptorReply& reply,
                                              const std::vector<CameraId>& cameras, SetId first_set,
                                              double gate_px) const {
  const MapCamera& camera = image.camera;
  if (!image.frame().valid()) return {};
  std::vector<const KeyImage*> asked;
  for (const CameraId c : cameras) {
    const auto newest =
        std::find_if(images_.rbegin(), images_.rend(), [&](const auto& i) { return i.second.camera == c; });
    if (newest != images_.rend() && newest->second.set >= first_set) asked.push_back(&newest->second);
  }
  if (asked.empty()) return {};
  const KnownPoints known = known_points(map, camera.map, asked);
  const NearMatches near = match_near(features_of(image, reply), image.frame().cam_from_world, known,
                                      [&](PointId id) { return !seen_by(*map.find(id), camera.id); });
  ExpectedPlace out;
  for (std::size_t i = 0; i < near.tracks.size(); ++i) {
    if (near.off_px[i] > gate_px) continue;
    out.in_place.emplace_back(near.tracks[i], known.ids[static_cast<std::size_t>(near.known[i])]);
  }
  if (static_cast<int>(out.in_place.size()) >= config_.min_expected && 2 * out.in_place.size() >= near.tracks.size()) {
    return out;
  }
  out.in_place.clear();
  // Few have to do, so they have to agree well: chance matches lie anywhere in what was searched.
  out.beside = locate(map, camera.id, asked, camera.map, known, near, {0.5 * kMatchSigma_px, config_.min_beside, 0});
  if (out.beside && 2 * out.beside->matches.size() < near.tracks.size()) out.beside.reset();
  if (out.beside) out.beside->expected = true;
  return out;
}

KeyImageDatabase::Asked KeyImageDatabase::asked_for(const Map& map, const std::vector<std::uint8_t>& descriptors,
                                                    const std::function<bool(const KeyImage&, MapId)>& may_ask) const {
  const std::vector<int> votes = index_.votes(descriptors);
  std::vector<std::pair<int, const KeyImage*>> order;
  for (const auto& [number, image] : images_) {
    const int n = votes[static_cast<std::size_t>(number)];
    if (n < config_.min_votes) continue;
    const FramePose* f = map.camera(image.camera).frame_at(image.set);
    if (!f->valid() || !may_ask(image, f->map)) continue;
    order.emplace_back(n, &image);
  }
  std::stable_sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  // The best image names the map; others of it lend their points.
  Asked asked;
  for (const auto& [n, image] : order) {
    const MapId map_id = map.camera(image->camera).frame_at(image->set)->map;
    if (asked.in == MapId()) asked.in = map_id;
    if (map_id == asked.in && static_cast<int>(asked.images.size()) < config_.around) asked.images.push_back(image);
  }
  return asked;
}

std::optional<PlaceMatch> KeyImageDatabase::find(const Map& map, const DescribedImage& image,
                                                 const DescriptorReply& reply,
                                                 const std::function<bool(const KeyImage&, MapId)>& may_ask) const {
  const Asked asked = asked_for(map, reply.descriptors, may_ask);
  if (asked.images.empty()) return std::nullopt;
  return locate_twice(map, asked.images, asked.in, features_of(image, reply), config_);
}

std::vector<const KeyImage*> KeyImageDatabase::images_of(const Map& map, MapId map_id) const {
  std::vector<const KeyImage*> out;
  for (const auto& [number, image] : images_) {
    const FramePose* f = map.camera(image.camera).frame_at(image.set);
    if (f != nullptr && f->valid() && f->map == map_id) out.push_back(&image);
  }
  return out;
}

std::set<MapId> KeyImageDatabase::maps(const Map& map) const {
  std::set<MapId> out;
  for (const auto& [number, image] : images_) {
    const FramePose* f = map.camera(image.camera).frame_at(image.set);
    if (f != nullptr && f->valid()) out.insert(f->map);
  }
  return out;
}

std::optional<LoopCandidate> KeyImageDatabase::find_again(
    const Map& map, const KeyImage& image, const std::function<bool(const KeyImage&, MapId)>& may_ask) const {
  const MapId map_id = map.camera(image.camera).frame_at(image.set)->map;
  const Asked asked = asked_for(map, image.descriptors, may_ask);
  if (asked.images.empty()) return std::nullopt;
  FeaturesOfImage features{map.camera(image.camera), image.tracks, image.descriptors, {}};
  LoopCandidate seen{.image = &image};
  for (const MapPoint* p : map.points_observed_in({{image.set, image.camera}})) {
    for (const KeyObservation& o : p->key_observations) {
      if (o.set != image.set || o.camera != image.camera || p->map != map_id) continue;
      features.pixels[o.track] = o.undistorted_px.cast<double>();
      seen.observed[o.track] = p->id;
    }
  }
  auto place = locate_twice(map, asked.images, asked.in, features, config_);
  if (!place) return std::nullopt;
  seen.place = std::move(*place);
  return seen;
}

void KeyImageDatabase::take_in(const KeyImageDatabase& other, const Renumbered& renumbered) {
  for (const auto& [number, theirs] : other.images_) {
    Renumber(renumbered).apply(images_[index_.add(theirs.descriptors)] = theirs);
  }
}

}  // namespace coslam
