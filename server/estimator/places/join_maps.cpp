// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/places/join_maps.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <set>

#include "common/geometry/alignment.h"
#include "common/geometry/robust.h"
#include "server/estimator/places/depth_ratio.h"
#include "server/estimator/places/scene_shape.h"
#include "server/estimator/places/witness.h"

namespace coslam {
namespace {

constexpr double kNear = 0.05;      // of the distance: points that are one
constexpr double kOfOneMind = 0.8;  // of the images: a few of many may be mistaken

// The one that most others agree with, and these.
std::vector<const Witness*> agreed(const std::vector<Witness>& all) {
  std::vector<const Witness*> best;
  for (const Witness& a : all) {
    std::vector<const Witness*> supporters{&a};
    for (const Witness& b : all) {
      if (agree(a, b)) supporters.push_back(&b);
    }
    if (supporters.size() > best.size()) best = std::move(supporters);
  }
  return best;
}

// All together give the size that each gives by itself, but for a few of many. Two prints of one room may hang nearly
// as those of another do, but not in the same proportion to their own size.
bool of_one_size(const Similarity3& fitted, const std::vector<const Witness*>& all) {
  constexpr double kScale = 0.05;
  const auto same = std::ranges::count_if(
      all, [&](const Witness* w) { return std::abs(std::log(w->into_from_own.scale / fitted.scale)) < kScale; });
  return static_cast<double>(same) >= kOfOneMind * static_cast<double>(all.size());
}

// Points that the images say are one: each once.
std::map<PointId, PointId> pairs_of(const std::vector<const Witness*>& witnesses) {
  std::map<PointId, PointId> pairs;
  std::set<PointId> known;
  for (const Witness* s : witnesses) {
    for (const auto& [own_id, other] : s->pairs) {
      if (!pairs.contains(own_id) && known.insert(other).second) pairs.emplace(own_id, other);
    }
  }
  return pairs;
}

// Fitted to the pairs that it brings together.
std::optional<Similarity3> fitted(const Map& map, const Similarity3& start, double depth,
                                  std::map<PointId, PointId>* pairs) {
  Similarity3 s = start;
  std::map<PointId, PointId> near;
  for (const double gate : {4 * kNear, 2 * kNear, kNear}) {
    std::vector<Eigen::Vector3d> from, to;
    near.clear();
    for (const auto& [own_id, other] : *pairs) {
      const Eigen::Vector3d &a = map.find(own_id)->position, &b = map.find(other)->position;
      if ((s * a - b).norm() > gate * depth) continue;
      near.emplace(own_id, other);
      from.push_back(a);
      to.push_back(b);
    }
    if (from.size() < kLeastPairs) return std::nullopt;
    const Alignment a = align_points(from, to, AlignmentScale::kFree);
    if (!a.target_from_source) return std::nullopt;
    s = *a.target_from_source;
  }
  *pairs = near;
  return s;
}

// What images of one map, of as many as it takes time for, say of places in others that may be asked.
std::vector<Witness> witnesses_in(const Map& map, const KeyImageDatabase& places, MapId map_id,
                                  const std::function<bool(MapId)>& may_ask) {
  constexpr std::size_t kMostImages = 200;
  const std::vector<const KeyImage*> images = places.images_of(map, map_id);
  const std::size_t apart = std::max<std::size_t>(1, (images.size() + kMostImages - 1) / kMostImages);
  std::vector<Witness> out;
  for (std::size_t i = 0; i < images.size(); i += apart) {
    const auto seen = places.find_again(map, *images[i], [&](const KeyImage&, MapId in) { return may_ask(in); });
    if (!seen) continue;
    if (auto witness = witness_of(map, *seen)) out.push_back(std::move(*witness));
  }
  return out;
}

// Its images about older maps, and theirs about it.
std::vector<Witness> all_witnesses(const Map& map, const KeyImageDatabase& places, MapId map_id, MapId first) {
  std::vector<Witness> out = witnesses_in(map, places, map_id, [&](MapId in) { return in != map_id && in < first; });
  for (MapId in(1); in < first; ++in.value) {
    if (in == map_id) continue;
    for (const Witness& w : witnesses_in(map, places, in, [&](MapId asked) { return asked == map_id; })) {
      out.push_back(reversed(w, in));
    }
  }
  return out;
}

std::optional<JoinedMaps> join(PlaceRecognitionEdit& edit, const KeyImageDatabase& places, MapId map_id, MapId first) {
  constexpr std::size_t kLeastImages = 2;
  const Map& map = edit.map();
  const std::vector<Witness> all = all_witnesses(map, places, map_id, first);
  const std::vector<const Witness*> good = agreed(all);
  if (good.size() < kLeastImages) return std::nullopt;
  std::map<PointId, PointId> pairs = pairs_of(good);
  std::vector<double> depths;
  depths.reserve(good.size());
  for (const Witness* s : good) depths.push_back(s->depth);
  const double depth = upper_median(depths);
  const auto into_from_own = fitted(map, good.front()->into_from_own, depth, &pairs);
  if (!into_from_own || !of_one_size(*into_from_own, good)) return std::nullopt;
  // What is flat in one map may only be uncertain there.
  std::vector<const MapPoint*> own_points, other_points;
  for (const auto& [own_id, other] : pairs) {
    own_points.push_back(map.find(own_id));
    other_points.push_back(map.find(other));
  }
  const bool relief = has_relief(other_points, depth) || has_relief(own_points, depth / into_from_own->scale);
  const bool of_one_mind = static_cast<double>(good.size()) > kOfOneMind * static_cast<double>(all.size());
  if (!relief && !(of_one_mind && covers_ground(other_points, std::ranges::max(depths)))) return std::nullopt;
  MapId remaining = good.front()->into, removed = map_id;
  Similarity3 remaining_from_removed = *into_from_own;
  if (map.is_metric(removed) && !map.is_metric(remaining)) {  // the one in metres keeps its frame
    std::swap(remaining, removed);
    remaining_from_removed = remaining_from_removed.inverse();
  }
  edit.merge(removed, remaining, remaining_from_removed);
  for (const auto& [own_id, other] : pairs)
    edit.fuse(other, own_id, Why::kPlaceRecognised, {static_cast<double>(pairs.size()), 0});
  return JoinedMaps{removed, remaining, static_cast<int>(good.size()), static_cast<int>(pairs.size()),
                    remaining_from_removed.scale};
}

}  // namespace

std::vector<JoinedMaps> join_all_maps(PlaceRecognitionEdit& edit, const KeyImageDatabase& places) {
  std::vector<JoinedMaps> out;
  for (MapId map_id(2); map_id < edit.map().next_map(); ++map_id.value) {
    if (const auto joined = join(edit, places, map_id, map_id)) out.push_back(*joined);
  }
  return out;
}

std::vector<JoinedMaps> join_maps(PlaceRecognitionEdit& edit, const KeyImageDatabase& places, MapId first) {
  std::vector<JoinedMaps> out;
  for (MapId map_id = first; map_id < edit.map().next_map(); ++map_id.value) {
    if (const auto joined = join(edit, places, map_id, first)) out.push_back(*joined);
  }
  return out;
}

}  // namespace coslam
