// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/places/join_maps.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "common/geometry/alignment.h"
#include "common/geometry/robust.h"

namespace coslam {
namespace {

constexpr double kNear = 0.05;  // of the distance: points that are one
constexpr std::size_t kLeastPairs = 10;

// What one image says of how two maps lie to each other.
struct Said {
  SetId set;
  MapId into;
  Similarity3 into_from_own;
  double depth = 0;  // in the older map
  Eigen::Vector3d center;
  std::vector<std::pair<PointId, PointId>> pairs;  // own, of the older map
};

std::optional<Said> said_by(const Map& map, const SeenAgain& seen) {
  constexpr double kMostSpread = 0.3;  // between the quartiles of the logarithm
  const FramePose& own = *map.camera(seen.image->camera).frame_at(seen.image->set);
  Said out{.set = seen.image->set, .into = seen.place.map, .depth = seen.place.median_depth};
  std::vector<double> ratios;
  for (const auto& [track, known] : seen.place.matches) {
    const MapPoint& of_own = *map.find(seen.own.at(track));
    const double here = (own.cam_from_world * of_own.position).z();
    const double there = (seen.place.cam_from_world * map.find(known)->position).z();
    if (here > 0 && there > 0) ratios.push_back(std::log(there / here));
    out.pairs.emplace_back(of_own.id, known);
  }
  if (ratios.size() < kLeastPairs) return std::nullopt;
  std::ranges::sort(ratios);
  if (ratios[ratios.size() * 3 / 4] - ratios[ratios.size() / 4] > kMostSpread) return std::nullopt;
  Similarity3& s = out.into_from_own;
  s.scale = std::exp(ratios[ratios.size() / 2]);
  s.rotation = (seen.place.cam_from_world.rotation.conjugate() * own.cam_from_world.rotation).normalized();
  s.translation = seen.place.cam_from_world.center() - s.scale * (s.rotation * own.cam_from_world.center());
  out.center = own.cam_from_world.center();
  return out;
}

bool agree(const Said& a, const Said& b) {
  constexpr double kTurn_rad = 0.05, kShift = 0.15, kScale = 0.15;
  return a.into == b.into && a.set != b.set &&
         a.into_from_own.rotation.angularDistance(b.into_from_own.rotation) < kTurn_rad &&
         std::abs(std::log(a.into_from_own.scale / b.into_from_own.scale)) < kScale &&
         (a.into_from_own * b.center - b.into_from_own * b.center).norm() < kShift * std::max(a.depth, b.depth);
}

// The one that most others agree with, and these.
std::vector<const Said*> agreed(const std::vector<Said>& all) {
  std::vector<const Said*> best;
  for (const Said& a : all) {
    std::vector<const Said*> with{&a};
    for (const Said& b : all) {
      if (agree(a, b)) with.push_back(&b);
    }
    if (with.size() > best.size()) best = std::move(with);
  }
  return best;
}

// Points that the images say are one: each once.
std::map<PointId, PointId> pairs_of(const std::vector<const Said*>& said) {
  std::map<PointId, PointId> pairs;
  std::set<PointId> known;
  for (const Said* s : said) {
    for (const auto& [own, other] : s->pairs) {
      if (!pairs.contains(own) && known.insert(other).second) pairs.emplace(own, other);
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
    for (const auto& [own, other] : *pairs) {
      const Eigen::Vector3d &a = map.find(own)->position, &b = map.find(other)->position;
      if ((s * a - b).norm() > gate * depth) continue;
      near.emplace(own, other);
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

std::vector<Said> all_said(const Map& map, const PlaceMemory& places, MapId of, MapId first) {
  std::vector<Said> out;
  for (const SeenAgain& seen : places.find_again(map, of, [&](MapId in) { return in != of && in < first; })) {
    if (auto said = said_by(map, seen)) out.push_back(std::move(*said));
  }
  return out;
}

std::optional<JoinedMaps> join(MapEdit& edit, const PlaceMemory& places, MapId of, MapId first) {
  constexpr std::size_t kLeastImages = 2;
  const Map& map = edit.map();
  const std::vector<Said> all = all_said(map, places, of, first);
  const std::vector<const Said*> good = agreed(all);
  if (good.size() < kLeastImages) return std::nullopt;
  std::map<PointId, PointId> pairs = pairs_of(good);
  std::vector<double> depths;
  depths.reserve(good.size());
  for (const Said* s : good) depths.push_back(s->depth);
  const double depth = upper_median(depths);
  const auto into_from_own = fitted(map, good.front()->into_from_own, depth, &pairs);
  if (!into_from_own) return std::nullopt;
  std::vector<const MapPoint*> evidence;
  evidence.reserve(pairs.size());
  for (const auto& [own, other] : pairs) evidence.push_back(map.find(other));
  if (!has_relief(evidence, depth)) return std::nullopt;
  MapId kept = good.front()->into, gone = of;
  Similarity3 by = *into_from_own;
  if (map.is_metric(gone) && !map.is_metric(kept)) {  // the one in metres keeps its frame
    std::swap(kept, gone);
    by = by.inverse();
  }
  edit.merge(gone, kept, by);
  for (const auto& [own, other] : pairs)
    edit.fuse(other, own, Why::kPlaceRecognised, {static_cast<double>(pairs.size()), 0});
  return JoinedMaps{gone, kept, static_cast<int>(good.size()), static_cast<int>(pairs.size()), by.scale};
}

}  // namespace

std::vector<JoinedMaps> join_maps(MapEdit& edit, const PlaceMemory& places, MapId first) {
  std::vector<JoinedMaps> out;
  for (MapId of = first; of < edit.map().next_map(); ++of.value) {
    if (const auto joined = join(edit, places, of, first)) out.push_back(*joined);
  }
  return out;
}

}  // namespace coslam
