// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/places/witness.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/estimator/places/depth_ratio.h"

namespace coslam {

std::optional<Witness> witness_of(const Map& map, const LoopCandidate& seen) {
  const FramePose& own_frame = *map.camera(seen.image->camera).frame_at(seen.image->set);
  Witness out{.set = seen.image->set,
              .camera = seen.image->camera,
              .place_image = {seen.place.key_set, seen.place.key_camera},
              .into = seen.place.map,
              .depth = seen.place.median_depth};
  std::vector<double> ratios;
  for (const auto& [track, known] : seen.place.matches) {
    const MapPoint& of_own = *map.find(seen.observed.at(track));
    const double own_depth = (own_frame.cam_from_world * of_own.position).z();
    const double place_depth = (seen.place.cam_from_world * map.find(known)->position).z();
    if (own_depth > 0 && place_depth > 0) ratios.push_back(std::log(place_depth / own_depth));
    out.pairs.emplace_back(of_own.id, known);
  }
  const auto ratio = depth_ratio(std::move(ratios));
  if (!ratio) return std::nullopt;
  Similarity3& s = out.into_from_own;
  s.scale = *ratio;
  s.rotation = (seen.place.cam_from_world.rotation.conjugate() * own_frame.cam_from_world.rotation).normalized();
  s.translation = seen.place.cam_from_world.center() - s.scale * (s.rotation * own_frame.cam_from_world.center());
  out.center = own_frame.cam_from_world.center();
  return out;
}

Witness reversed(const Witness& w, MapId own_map) {
  Witness out = w;
  out.into = own_map;
  out.into_from_own = w.into_from_own.inverse();
  out.depth = w.depth / w.into_from_own.scale;
  out.center = w.into_from_own * w.center;
  for (auto& [first, second] : out.pairs) std::swap(first, second);
  return out;
}

bool agree(const Witness& a, const Witness& b) {
  constexpr double kShift = 0.15;
  const ImageKey of_a(a.set, a.camera), of_b(b.set, b.camera);
  const bool same_images = of_a == of_b || (of_a == b.place_image && of_b == a.place_image);
  return a.into == b.into && !same_images &&
         a.into_from_own.rotation.angularDistance(b.into_from_own.rotation) < kSameTurn_rad &&
         std::abs(std::log(a.into_from_own.scale / b.into_from_own.scale)) < kSameScale &&
         (a.into_from_own * b.center - b.into_from_own * b.center).norm() < kShift * std::max(a.depth, b.depth);
}

}  // namespace coslam
