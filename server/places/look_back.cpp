// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/places/look_back.h"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include "common/geometry/robust.h"
#include "server/associate/register.h"
#include "server/places/witness.h"

namespace coslam {
namespace {

constexpr std::size_t kMostImages = 400;  // the newest: earlier ones had their time
constexpr int kMostLoops = 8;
constexpr double kOneVisit_s = 5.0;  // between images that tell of one and the same loop

// One that shows an earlier visit, with what the map makes of it now.
struct Visit {
  SeenAgain seen;
  std::optional<Witness> witness;
};

const FramePose& own_frame(const Map& map, const SeenAgain& seen) {
  return *map.camera(seen.image->camera).frame_at(seen.image->set);
}

// Most of the points that match are one already.
bool known(const SeenAgain& seen) {
  const auto same = std::ranges::count_if(seen.place.matches,
                                          [&](const auto& match) { return seen.own.at(match.first) == match.second; });
  return 2 * same > static_cast<std::ptrdiff_t>(seen.place.matches.size());
}

// The place's points lie where the image saw them.
bool in_place(const Map& map, const SeenAgain& seen) {
  const MapCamera& camera = map.camera(seen.image->camera);
  std::vector<double> errors;
  for (const auto& [track, point] : seen.place.matches) {
    Eigen::Vector2d px;
    const MapPoint& p = *map.find(point);
    if (!project_world(camera.model, own_frame(map, seen).cam_from_world, p.position, &px)) return false;
    const MapPoint& own = *map.find(seen.own.at(track));
    for (const KeyObservation& o : own.key_observations) {
      if (o.set == seen.image->set && o.camera == camera.id)
        errors.push_back((px - o.undistorted_px.cast<double>()).norm());
    }
  }
  return upper_median(errors) < map.config().theta * map.gate_sigma_px(camera);
}

std::vector<Visit> find_visits(const Map& map, const PlaceMemory& places, MapId of) {
  std::vector<const KeyImage*> images = places.images_of(map, of);
  if (images.size() > kMostImages) images.erase(images.begin(), images.end() - kMostImages);
  const auto apart = static_cast<std::uint32_t>(map.sets_in(map.config().recent_s));
  std::vector<Visit> out;
  for (const KeyImage* image : images) {
    auto seen = places.find_again(map, *image, [&](const KeyImage& other, MapId in) {
      return in == of && other.set.value + apart < image->set.value;
    });
    if (seen && !known(*seen)) out.push_back({std::move(*seen), {}});
  }
  return out;
}

// How many of its points became one with the place's.
int link(MapEdit& edit, const SeenAgain& seen) {
  const Map& map = edit.map();
  int fused = 0;
  const Figures agree{static_cast<double>(seen.place.matches.size()), 0};
  for (const auto& [track, place_point] : seen.place.matches) {
    const MapPoint *own = map.find(seen.own.at(track)), *kept = map.find(place_point);
    if (own == nullptr || kept == nullptr || own == kept) continue;
    if (!own->rests() || !kept->rests() || seen_at_once(*own, *kept)) continue;
    edit.fuse(kept->id, own->id, Why::kPlaceRecognised, agree);
    retriangulate(edit, *kept);
    ++fused;
  }
  return fused;
}

bool all_there(const Map& map, const SeenAgain& seen) {
  return std::ranges::all_of(seen.place.matches, [&](const auto& match) {
    return map.find(match.second) != nullptr && map.find(seen.own.at(match.first)) != nullptr;
  });
}

bool of_one_visit(const Map& map, const Witness& a, const Witness& b) {
  const auto apart = a.set > b.set ? a.set.value - b.set.value : b.set.value - a.set.value;
  return apart <= static_cast<std::uint32_t>(map.sets_in(kOneVisit_s)) && agree(a, b);
}

// The visit that most others confirm.
const Visit* most_confirmed(const Map& map, const std::vector<Visit>& visits, int min_inliers) {
  const Visit* best = nullptr;
  std::size_t most = 0;
  for (const Visit& v : visits) {
    if (!v.witness || static_cast<int>(v.seen.place.matches.size()) < min_inliers) continue;
    std::size_t confirm = 0;
    std::set<PointId> ids;
    for (const auto& [own, other] : v.witness->pairs) ids.insert(other);
    for (const Visit& w : visits) {
      if (!w.witness || !of_one_visit(map, *v.witness, *w.witness)) continue;
      ++confirm;
      for (const auto& [own, other] : w.witness->pairs) ids.insert(other);
    }
    if (confirm <= most) continue;
    std::vector<const MapPoint*> evidence;
    evidence.reserve(ids.size());
    for (const PointId id : ids) evidence.push_back(map.find(id));
    if (!has_relief(evidence, v.witness->depth)) continue;
    most = confirm;
    best = &v;
  }
  return best;
}

std::optional<LoopConstraint> constraint_of(const Map& map, const Visit& v) {
  const Recognition& place = v.seen.place;
  const FramePose* there = map.camera(place.key_camera).frame_at(place.key_set);
  if (there == nullptr) return std::nullopt;
  return LoopConstraint{v.seen.image->camera,
                        place.key_camera,
                        v.seen.image->set,
                        place.key_set,
                        place.cam_from_world * there->cam_from_world.inverse(),
                        v.witness->into_from_own.scale};
}

}  // namespace

LookBackReport look_back(MapEdit& edit, const PlaceMemory& places, MapId of, int min_inliers,
                         std::vector<LoopConstraint>* loops) {
  const Map& map = edit.map();
  LookBackReport report;
  for (int round = 0; round <= kMostLoops; ++round) {
    std::vector<Visit> visits = find_visits(map, places, of);
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
    const Visit* best = round < kMostLoops ? most_confirmed(map, visits, min_inliers) : nullptr;
    if (best == nullptr) break;
    const auto loop = constraint_of(map, *best);
    if (!loop || !close_loop(edit, of, *loop, *loops, {})) break;
    loops->push_back(*loop);
    ++report.closed;
    link(edit, best->seen);
  }
  return report;
}

}  // namespace coslam
