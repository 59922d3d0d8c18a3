// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/places/confirm.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace coslam {
namespace {

constexpr double kPending_s = 5.0;        // within which a hypothesis is to be confirmed
constexpr std::size_t kBeyondDoubt = 40;  // matches, of either image
constexpr double kFlat_s = 30.0;          // the same of ground, of which one image shows a part

std::vector<const MapPoint*> points_in(const Map& map, MapId of, const std::set<PointId>& ids) {
  std::vector<const MapPoint*> out;
  for (const PointId id : ids) {
    const MapPoint* p = map.find(id);
    if (p != nullptr && p->map == of) out.push_back(p);
  }
  return out;
}

// Whether the camera is where this says that it is. Beyond doubt: in so many points that it is the same place, and one
// of the maps may be as bent as young ones are; the adjustment of both together straightens it.
bool agree(const DescribedImage& image, const Recognition& seen, const Similarity3& said, const Similarity3& now,
           bool beyond_doubt) {
  constexpr double kTurn_rad = 0.05, kShift = 0.1, kScale = 0.15, kBent = 3;
  const double slack = beyond_doubt ? kBent : 1;
  const Rigid3 expected = transform_world(image.frame().cam_from_world, said);
  return expected.rotation.angularDistance(seen.cam_from_world.rotation) < slack * kTurn_rad &&
         (expected.center() - seen.cam_from_world.center()).norm() < slack * kShift * seen.median_depth &&
         std::abs(std::log(said.scale / now.scale)) < slack * kScale;
}

// Farther from where the camera's pose says than maps drift.
bool is_far(const DescribedImage& image, const Recognition& seen) {
  constexpr double kFar = 0.3;
  return (image.frame().cam_from_world.center() - seen.cam_from_world.center()).norm() > kFar * seen.median_depth;
}

}  // namespace

// The camera's, and that of the place.
std::pair<Verification::Part, Verification::Part> Verification::parts(const Map& map, const MapCamera& camera,
                                                                      const Recognition& seen, const ViewGraph& graph) {
  if (camera.map != seen.map) return {{camera.map, std::nullopt}, {seen.map, std::nullopt}};
  const CameraId own = graph.group_with(camera.id).front(), other = graph.group_with(seen.key_camera).front();
  const bool past = own == other || !map.is_recent(seen.key_set);
  return {{camera.map, own}, {camera.map, past ? std::nullopt : std::optional(other)}};
}

bool Verification::confirmed(const Map& map, const DescribedImage& image, const Recognition& seen,
                             const Similarity3& in_from_own, const ViewGraph& graph, bool enough) {
  const MapCamera& camera = image.camera;
  const auto [own, other] = parts(map, camera, seen, graph);
  const bool forward = own < other;
  const Hypothesis hypothesis = forward ? Hypothesis{own, other} : Hypothesis{other, own};
  const Similarity3 second_from_first = forward ? in_from_own : in_from_own.inverse();
  std::set<PointId> evidence;
  for (const auto& [track, point] : seen.matches) evidence.insert(point);
  if (own.map == other.map && enough && !seen.expected && is_far(image, seen)) {
    if (!has_relief(points_in(map, seen.map, evidence), seen.median_depth)) repeating_.insert(own.map);
  }
  const auto at = pending_.find(hypothesis);
  if (at != pending_.end() &&
      at->second.since.value + map.sets_in(at->second.flat ? kFlat_s : kPending_s) > map.now().value) {
    Pending& p = at->second;
    const Similarity3 said = forward ? p.second_from_first : p.second_from_first.inverse();
    const bool beyond_doubt = own.map != other.map && std::min(p.matches, seen.matches.size()) >= kBeyondDoubt;
    if (agree(image, seen, said, in_from_own, beyond_doubt)) {
      p.evidence.merge(evidence);
      p.cameras.insert({camera.id, seen.key_camera});
      p.enough = p.enough || enough;
      if (p.since == map.now()) return false;  // of the same instant
      p.second_from_first = second_from_first;
      if (!p.enough) return false;
      const std::vector<const MapPoint*> all = points_in(map, seen.map, p.evidence);
      const bool relief = seen.expected || has_relief(all, seen.median_depth);
      if (!relief && !flat_is_enough(hypothesis, all, seen.median_depth)) {
        p.since = map.now();  // more of it may come
        p.flat = true;
        return false;
      }
      pending_.erase(at);
      return true;
    }
    if (p.enough && !enough) return false;  // few points that say something else take nothing away
    if (enough && p.enough) repeating_.insert({own.map, other.map});
  }
  pending_[hypothesis] = {.second_from_first = second_from_first,
                          .since = map.now(),
                          .expected = seen.expected,
                          .enough = enough,
                          .matches = seen.matches.size(),
                          .evidence = std::move(evidence),
                          .cameras = {camera.id, seen.key_camera}};
  return false;
}

// Of one map it only tells that the map repeats itself: its poses say where that is.
bool Verification::flat_is_enough(const Hypothesis& hypothesis, const std::vector<const MapPoint*>& evidence,
                                  double median_depth) const {
  const MapId first = hypothesis.first.map, second = hypothesis.second.map;
  return first != second && !repeating_.contains(first) && !repeating_.contains(second) &&
         covers_ground(evidence, median_depth);
}

void Verification::drawn_together(MapId map) {
  std::erase_if(pending_, [&](const auto& p) { return p.first.first.map == map && p.first.second.map == map; });
}

void Verification::joined(MapId map) {
  std::erase_if(pending_, [&](const auto& p) { return p.first.first.map == map || p.first.second.map == map; });
}

Verification::Waiting Verification::waiting(const Map& map, CameraId camera) const {
  Waiting most = Waiting::kNothing;
  for (const auto& [hypothesis, p] : pending_) {
    if (!p.cameras.contains(camera) || p.since.value + map.sets_in(kPending_s) <= map.now().value) continue;
    most = std::max(most, p.expected ? Waiting::kExpected : Waiting::kAnywhere);
  }
  return most;
}

}  // namespace coslam
