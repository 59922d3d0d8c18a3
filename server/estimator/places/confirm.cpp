// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/places/confirm.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "server/estimator/places/scene_shape.h"
#include "server/estimator/places/witness.h"

namespace coslam {
namespace {

constexpr double kFlat_s = 30.0;          // the same of ground, of which one image shows a part
constexpr double kRepeats_s = 120;        // after something flat was last seen in two places
constexpr std::size_t kBeyondDoubt = 40;  // matches of either image, in one of them not on one plane

std::vector<const MapPoint*> points_in(const Map& map, MapId map_id, const std::set<PointId>& ids) {
  std::vector<const MapPoint*> out;
  for (const PointId id : ids) {
    const MapPoint* p = map.find(id);
    if (p != nullptr && p->map == map_id) out.push_back(p);
  }
  return out;
}

// Whether the camera is where this says that it is. Beyond doubt: in so many points that it is the same place, and one
// of the maps may be as bent as young ones are; the adjustment of both together straightens it.
bool agree(const DescribedImage& image, const PlaceMatch& seen, const Similarity3& earlier, const Similarity3& now,
           bool beyond_doubt) {
  constexpr double kShift = 0.1, kBent = 3;
  const double slack = beyond_doubt ? kBent : 1;
  const Rigid3 expected = transform_world(image.frame().cam_from_world, earlier);
  return expected.rotation.angularDistance(seen.cam_from_world.rotation) < slack * kSameTurn_rad &&
         (expected.center() - seen.cam_from_world.center()).norm() < slack * kShift * seen.median_depth &&
         std::abs(std::log(earlier.scale / now.scale)) < slack * kSameScale;
}

// Farther from where the camera's pose says than young maps drift. One that has drifted so far only loses that flat
// ground joins it.
bool is_far(const DescribedImage& image, const PlaceMatch& seen) {
  constexpr double kFar = 0.3;
  return (image.frame().cam_from_world.center() - seen.cam_from_world.center()).norm() > kFar * seen.median_depth;
}

}  // namespace

// The camera's, and that of the place.
std::pair<Verification::Part, Verification::Part> Verification::parts(const Map& map, const MapCamera& camera,
                                                                      const PlaceMatch& seen, const ViewGraph& graph) {
  if (camera.map != seen.map) return {{camera.map, std::nullopt}, {seen.map, std::nullopt}};
  const CameraId own_first = graph.group_with(camera.id).front(), other = graph.group_with(seen.key_camera).front();
  const bool past = own_first == other || !map.is_recent(seen.key_set);
  return {{camera.map, own_first}, {camera.map, past ? std::nullopt : std::optional(other)}};
}

PlaceDoubt Verification::examine(const Map& map, const DescribedImage& image, const PlaceMatch& seen,
                                 const Similarity3& in_from_own, const ViewGraph& graph, bool enough) {
  const MapCamera& camera = image.camera;
  const auto [own_part, other] = parts(map, camera, seen, graph);
  const bool forward = own_part < other;
  const Hypothesis hypothesis = forward ? Hypothesis{own_part, other} : Hypothesis{other, own_part};
  Pending now{.second_from_first = forward ? in_from_own : in_from_own.inverse(),
              .first = map.now(),
              .newest = map.now(),
              .expected = seen.expected,
              .enough = enough,
              .depth = seen.median_depth,
              .cameras = {camera.id, seen.key_camera}};
  for (const auto& [track, point] : seen.matches) now.evidence.insert(point);
  now.relief = has_relief(points_in(map, seen.map, now.evidence), seen.median_depth);
  now.many = own_part.map != other.map && seen.matches.size() >= kBeyondDoubt;
  if (own_part.map == other.map && enough && !now.relief && !seen.expected && is_far(image, seen))
    repeats(map, own_part.map);
  PlaceDoubt doubt = PlaceDoubt::kUnconfirmed;
  const auto at = pending_.find(hypothesis);
  if (at != pending_.end() &&
      at->second.newest.value + map.sets_in(at->second.flat ? kFlat_s : kOneVisit_s) > map.now().value) {
    Pending& p = at->second;
    const Similarity3 earlier = forward ? p.second_from_first : p.second_from_first.inverse();
    if (agree(image, seen, earlier, in_from_own, p.many && now.many && (p.relief || now.relief))) {
      p.evidence.merge(now.evidence);
      p.cameras.merge(now.cameras);
      p.enough = p.enough || enough;
      p.relief = p.relief || now.relief;
      p.depth = std::max(p.depth, now.depth);
      if (p.newest == map.now()) return PlaceDoubt::kUnconfirmed;  // of the same instant
      p.second_from_first = now.second_from_first;
      p.many = now.many;
      if (!p.enough) return PlaceDoubt::kTooFewFeatures;
      const std::vector<const MapPoint*> all = points_in(map, seen.map, p.evidence);
      if (!seen.expected && !has_relief(all, seen.median_depth) && !flat_is_enough(map, hypothesis, all, p.depth)) {
        p.newest = map.now();  // more of it may come
        p.flat = true;
        return PlaceDoubt::kFlat;
      }
      pending_.erase(at);
      return PlaceDoubt::kNone;
    }
    // Few points that say something else take nothing away.
    if (p.enough && !enough) return PlaceDoubt::kTooFewFeatures;
    if (enough && p.enough && !now.relief && !p.relief) repeats(map, own_part.map), repeats(map, other.map);
    doubt = PlaceDoubt::kContradicted;
  }
  pending_[hypothesis] = std::move(now);
  return doubt;
}

void Verification::repeats(const Map& map, MapId id) { repeating_[id] = map.now(); }

// Of one map it only tells that the map repeats itself: its poses say where that is.
bool Verification::flat_is_enough(const Map& map, const Hypothesis& hypothesis,
                                  const std::vector<const MapPoint*>& evidence, double farthest_depth) const {
  const auto repeats_itself = [&](MapId id) {
    const auto at = repeating_.find(id);
    return at != repeating_.end() && at->second.value + map.sets_in(kRepeats_s) > map.now().value;
  };
  const MapId first = hypothesis.first.map, second = hypothesis.second.map;
  return first != second && !repeats_itself(first) && !repeats_itself(second) &&
         covers_ground(evidence, farthest_depth);
}

void Verification::drawn_together(MapId map) {
  std::erase_if(pending_, [&](const auto& p) { return p.first.first.map == map && p.first.second.map == map; });
}

void Verification::joined(MapId one, MapId other) {
  const auto is_either = [&](const Part& p) { return p.map == one || p.map == other; };
  std::erase_if(pending_, [&](const auto& p) { return is_either(p.first.first) || is_either(p.first.second); });
  for (const auto& [from, to] : {std::pair(one, other), std::pair(other, one)}) {
    if (!repeating_.contains(from)) continue;
    const SetId last = repeating_[from];
    repeating_[to] = std::max(repeating_[to], last);
  }
}

Verification::Waiting Verification::waiting(const Map& map, CameraId camera) const {
  Waiting most = Waiting::kNothing;
  for (const auto& [hypothesis, p] : pending_) {
    const bool more = p.flat && p.first.value + map.sets_in(kOneVisit_s) <= map.now().value;
    const double wait_s = more ? kFlat_s : kOneVisit_s;
    if (!p.cameras.contains(camera) || p.newest.value + map.sets_in(wait_s) <= map.now().value) continue;
    most = std::max(most, more ? Waiting::kMore : p.expected ? Waiting::kExpected : Waiting::kAnywhere);
  }
  return most;
}

}  // namespace coslam
