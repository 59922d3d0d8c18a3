// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/places/offline_loops.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "common/geometry/robust.h"
#include "server/estimator/associate/register.h"
#include "server/estimator/places/scene_shape.h"
#include "server/estimator/places/witness.h"

namespace coslam {
namespace {

constexpr std::size_t kMostImages = 400;  // the newest: earlier ones had their time
constexpr int kMostOfflineLoops = 8;
constexpr double kDrawn = 2;  // gates, for what a loop was closed by: the map is as good as that at first

// One that shows an earlier visit, with what the map makes of it now.
struct Visit {
  LoopCandidate seen;
  std::optional<Witness> witness;
};

const FramePose& own_frame(const Map& map, const LoopCandidate& seen) {
  return *map.camera(seen.image->camera).frame_at(seen.image->set);
}

// Most of the points that match are one already.
bool known(const LoopCandidate& seen) {
  const auto same = std::ranges::count_if(
      seen.place.matches, [&](const auto& match) { return seen.observed.at(match.first) == match.second; });
  return 2 * same > static_cast<std::ptrdiff_t>(seen.place.matches.size());
}

// How far from where the image saw it the place's point lies; nothing when one of the two points is gone.
std::optional<double> off_px(const Map& map, const LoopCandidate& seen, const std::pair<TrackId, PointId>& match) {
  const MapCamera& camera = map.camera(seen.image->camera);
  const MapPoint *own_point = map.find(seen.observed.at(match.first)), *place = map.find(match.second);
  if (own_point == nullptr || place == nullptr) return std::nullopt;
  Eigen::Vector2d px;
  if (!project_world(camera.model, own_frame(map, seen).cam_from_world, place->position, &px)) {
    return std::numeric_limits<double>::infinity();
  }
  for (const KeyObservation& o : own_point->key_observations) {
    if (o.set == seen.image->set && o.camera == camera.id) return (px - o.undistorted_px.cast<double>()).norm();
  }
  return std::nullopt;
}

double gate_px(const Map& map, const LoopCandidate& seen) {
  return map.config().theta * map.gate_sigma_px(map.camera(seen.image->camera));
}

// The place's points lie where the image saw them.
bool in_place(const Map& map, const LoopCandidate& seen, double gates = 1) {
  std::vector<double> errors;
  for (const auto& match : seen.place.matches) {
    if (const auto px = off_px(map, seen, match)) errors.push_back(*px);
  }
  return !errors.empty() && upper_median(errors) < gates * gate_px(map, seen);
}

std::vector<Visit> find_visits(const Map& map, const KeyImageDatabase& places, MapId map_id) {
  std::vector<const KeyImage*> images = places.images_of(map, map_id);
  if (images.size() > kMostImages) images.erase(images.begin(), images.end() - kMostImages);
  const auto apart = static_cast<std::uint32_t>(map.sets_in(map.config().recent_s));
  std::vector<Visit> out;
  for (const KeyImage* image : images) {
    auto seen = places.find_again(map, *image, [&](const KeyImage& other, MapId in) {
      return in == map_id && other.set.value + apart < image->set.value;
    });
    if (seen && !known(*seen)) out.push_back({std::move(*seen), {}});
  }
  return out;
}

// How many of its points became one with the place's: those that lie where the image saw them.
int link(PlaceRecognitionEdit& edit, const LoopCandidate& seen, double gates = 1) {
  const Map& map = edit.map();
  int fused = 0;
  const Figures agree{static_cast<double>(seen.place.matches.size()), 0};
  for (const auto& [track, place_point] : seen.place.matches) {
    const auto px = off_px(map, seen, {track, place_point});
    if (!px || *px > gates * gate_px(map, seen)) continue;
    const MapPoint *own_point = map.find(seen.observed.at(track)), *kept = map.find(place_point);
    if (own_point == kept) continue;
    if (!own_point->rests() || !kept->rests() || seen_at_once(*own_point, *kept)) continue;
    edit.fuse(kept->id, own_point->id, Why::kPlaceRecognised, agree);
    retriangulate(edit, *kept);
    ++fused;
  }
  return fused;
}

bool all_there(const Map& map, const LoopCandidate& seen) {
  return std::ranges::all_of(seen.place.matches, [&](const auto& match) {
    return map.find(match.second) != nullptr && map.find(seen.observed.at(match.first)) != nullptr;
  });
}

bool of_one_visit(const Map& map, const Witness& a, const Witness& b) {
  const auto apart = a.set > b.set ? a.set.value - b.set.value : b.set.value - a.set.value;
  return apart <= static_cast<std::uint32_t>(map.sets_in(kOneVisit_s)) && agree(a, b);
}

// A visit and those that confirm it, itself first; of these there are two or more.
using Confirmed = std::vector<const Visit*>;

std::set<PointId> points_of(const Confirmed& visits) {
  std::set<PointId> ids;
  for (const Visit* v : visits) {
    for (const auto& [own_id, other] : v->witness->pairs) ids.insert(other);
  }
  return ids;
}

// One image has to tell by itself, or three together.
bool enough(const Confirmed& visits, std::size_t points, int min_inliers) {
  const bool one = std::ranges::any_of(
      visits, [&](const Visit* v) { return static_cast<int>(v->seen.place.matches.size()) >= min_inliers; });
  return one || (visits.size() >= 3 && static_cast<int>(points) >= 2 * min_inliers);
}

std::pair<std::size_t, std::size_t> rank(const Confirmed& visits) {
  return {visits.size(), visits.empty() ? 0 : visits.front()->seen.place.matches.size()};
}

// The visit that most others confirm; among equals the one that tells most.
Confirmed most_confirmed(const Map& map, const std::vector<Visit>& visits, int min_inliers) {
  Confirmed best;
  for (const Visit& v : visits) {
    if (!v.witness) continue;
    Confirmed all{&v};
    for (const Visit& w : visits) {
      if (w.witness && of_one_visit(map, *v.witness, *w.witness)) all.push_back(&w);
    }
    if (all.size() < 2 || rank(all) <= rank(best)) continue;
    const std::set<PointId> ids = points_of(all);
    if (!enough(all, ids.size(), min_inliers)) continue;
    std::vector<const MapPoint*> evidence;
    evidence.reserve(ids.size());
    for (const PointId id : ids) evidence.push_back(map.find(id));
    if (has_relief(evidence, v.witness->depth)) best = std::move(all);
  }
  return best;
}

// Where all of them say that the first one's image was taken: what one tells by a few points is off by more than the
// map has drifted.
std::optional<LoopConstraint> constraint_of(const Map& map, const Confirmed& visits) {
  const Visit& v = *visits.front();
  const PlaceMatch& place = v.seen.place;
  const FramePose* key_frame = map.camera(place.key_camera).frame_at(place.key_set);
  if (key_frame == nullptr) return std::nullopt;
  const Rigid3& own_pose = own_frame(map, v.seen).cam_from_world;
  double weight = 0, log_scale = 0;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Eigen::Vector4d rotation = Eigen::Vector4d::Zero();
  for (const Visit* w : visits) {
    const Similarity3& s = w->witness->into_from_own;
    const auto points = static_cast<double>(w->seen.place.matches.size());
    const Eigen::Quaterniond of_camera = s.rotation * own_pose.rotation.conjugate();
    const double sign = of_camera.coeffs().dot(rotation) < 0 ? -1 : 1;
    weight += points;
    log_scale += points * std::log(s.scale);
    center += points * (s * own_pose.center());
    rotation += points * sign * of_camera.coeffs();
  }
  center /= weight;
  const Eigen::Quaterniond cam_from_world = Eigen::Quaterniond(rotation.normalized()).conjugate();
  const Rigid3 mean_pose{cam_from_world, -(cam_from_world * center)};
  return LoopConstraint{v.seen.image->camera,
                        place.key_camera,
                        v.seen.image->set,
                        place.key_set,
                        mean_pose * key_frame->cam_from_world.inverse(),
                        std::exp(log_scale / weight)};
}

}  // namespace

OfflineLoopsReport close_loops_offline(PlaceRecognitionEdit& edit, const KeyImageDatabase& places, MapId map_id,
                                       int min_inliers, std::vector<LoopConstraint>* loops) {
  const Map& map = edit.map();
  OfflineLoopsReport report;
  for (int round = 0; round <= kMostOfflineLoops; ++round) {
    std::vector<Visit> visits = find_visits(map, places, map_id);
    for (Visit& v : visits) {
      if (!all_there(map, v.seen)) continue;
      if (in_place(map, v.seen)) {
        report.linked += link(edit, v.seen) > 0;
      } else {
        v.witness = witness_of(map, v.seen);
      }
    }
    for (Visit& v : visits) {
      if (v.witness && !all_there(map, v.seen)) v.witness.reset();
    }
    const Confirmed best = round < kMostOfflineLoops ? most_confirmed(map, visits, min_inliers) : Confirmed();
    if (best.empty()) break;
    const auto loop = constraint_of(map, best);
    if (!loop || !close_loop(edit, map_id, *loop, *loops, {})) break;
    loops->push_back(*loop);
    ++report.closed;
    // Not one alone: the adjustment goes by what becomes one point.
    for (const Visit* v : best) {
      if (in_place(map, v->seen, kDrawn)) link(edit, v->seen, kDrawn);
    }
  }
  return report;
}

}  // namespace coslam
