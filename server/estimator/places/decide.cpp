// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/places/decide.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/geometry/robust.h"
#include "server/estimator/places/depth_ratio.h"
#include "server/estimator/places/scene_shape.h"

namespace coslam {
namespace {

std::vector<const MapPoint*> points_of(const Map& map, const PlaceMatch& seen) {
  std::vector<const MapPoint*> out;
  for (const auto& [track, point] : seen.matches) out.push_back(map.find(point));
  return out;
}

// Depth of the camera's own map at a track: of its point, or of that of the nearest track not far from it.
std::optional<double> own_depth(const Map& map, const DescribedImage& image, TrackId track, bool exact) {
  constexpr double kNear = 0.025;  // of the image width
  const auto own_point = image.points.find(track);
  const MapPoint* best = own_point == image.points.end() ? nullptr : map.find(own_point->second);
  if (best == nullptr && !exact) {
    float nearest = static_cast<float>(kNear * image.camera.model.width_px);
    const Eigen::Vector2f& px = image.pixels.at(track);
    for (const auto& [id, point] : image.points) {
      const MapPoint* p = map.find(point);
      if (p == nullptr || !p->rests()) continue;
      const float d = (image.pixels.at(id) - px).norm();
      if (d >= nearest) continue;
      nearest = d;
      best = p;
    }
  }
  if (best == nullptr || !best->rests()) return std::nullopt;
  return (image.frame().cam_from_world * best->position).z();
}

// Lengths in the place's map over those in the camera's own, from depths in both; empty when they do not agree.
std::optional<double> scale_of(const Map& map, const DescribedImage& image, const PlaceMatch& seen) {
  std::vector<double> ratios;
  for (const bool exact : {true, false}) {
    ratios.clear();
    for (const auto& [track, point] : seen.matches) {
      const auto depth = own_depth(map, image, track, exact);
      const double other = (seen.cam_from_world * map.find(point)->position).z();
      if (depth && *depth > 0 && other > 0) ratios.push_back(std::log(other / *depth));
    }
    if (ratios.size() >= kLeastPairs) break;
  }
  return depth_ratio(std::move(ratios));
}

// From the camera's pose in both.
std::optional<Similarity3> similarity_of(const Map& map, const DescribedImage& image, const PlaceMatch& seen) {
  const auto scale = scale_of(map, image, seen);
  if (!scale) return std::nullopt;
  const Rigid3& own_pose = image.frame().cam_from_world;
  Similarity3 s;
  s.scale = *scale;
  s.rotation = (seen.cam_from_world.rotation.conjugate() * own_pose.rotation).normalized();
  s.translation = seen.cam_from_world.center() - s.scale * (s.rotation * own_pose.center());
  return s;
}

// It had a pose in that map not long ago, and nearer to there than what it sees.
bool where_it_was_lost(const Map& map, const CameraFrames& camera, const PlaceMatch& seen) {
  for (std::size_t i = camera.frames.size(); i-- > 0;) {
    const FramePose& f = camera.frames[i];
    if (!map.is_recent(f.set)) return false;
    if (!f.valid()) continue;
    return f.map == seen.map && (f.cam_from_world.center() - seen.cam_from_world.center()).norm() < seen.median_depth;
  }
  return false;
}

PlaceDecision too_few(const PlaceMatch& seen) {
  return {.action = PlaceDecision::kTooFew, .seen = seen, .in_from_own = {}, .doubt = PlaceDoubt::kTooFewFeatures};
}

PlaceDecision doubtful(const PlaceMatch& seen, PlaceDoubt doubt) {
  return {.action = PlaceDecision::kDoubtful, .seen = seen, .in_from_own = {}, .doubt = doubt};
}

bool may_be_placed(const Map& map, const MapCamera& camera, const PlaceMatch& seen) {
  return has_relief(points_of(map, seen), seen.median_depth) || where_it_was_lost(map, camera, seen);
}

// The known points lie where the camera's own pose expects them.
bool as_expected(const Map& map, const DescribedImage& image, const PlaceMatch& seen, double most_px) {
  std::vector<double> errors;
  for (const auto& [track, point] : seen.matches) {
    Eigen::Vector2d px;
    if (!project_world(image.camera.model, image.frame().cam_from_world, map.find(point)->position, &px, nullptr))
      return false;
    errors.push_back((px - image.pixels.at(track).cast<double>()).norm());
  }
  return upper_median(errors) < most_px;
}

}  // namespace

PlaceDecision PlaceJudge::decide(const Map& map, const DescribedImage& image, std::optional<PlaceMatch> seen,
                                 ExpectedPlace expected, const ViewGraph& graph) {
  const MapCamera& camera = image.camera;
  if (!expected.in_place.empty()) return {PlaceDecision::kSeenAsExpected, {.matches = std::move(expected.in_place)}};
  const bool unplaced = camera.map == MapId();
  const int least = unplaced ? config_.min_place_inliers : config_.min_merge_inliers;
  const bool enough = seen && static_cast<int>(seen->matches.size()) >= least;
  if (!enough && expected.beside) seen = std::move(expected.beside);
  if (!seen) return {PlaceDecision::kUnknown};
  if (unplaced && !enough) return too_few(*seen);
  if (unplaced && !may_be_placed(map, camera, *seen)) return doubtful(*seen, PlaceDoubt::kFlat);
  if (unplaced) return {PlaceDecision::kPlace, *seen};
  // Few are not enough by themselves, but may be the one of two images of a loop.
  const bool few = !enough && !seen->expected;
  if (few && seen->map != camera.map) return too_few(*seen);
  if (seen->map == camera.map && as_expected(map, image, *seen, slack_px(map, camera))) {
    return few ? too_few(*seen) : PlaceDecision{PlaceDecision::kLink, *seen};
  }
  const auto similarity = similarity_of(map, image, *seen);
  const PlaceDoubt doubt =
      similarity ? verification_.examine(map, image, *seen, *similarity, graph, !few) : PlaceDoubt::kScalesDisagree;
  if (doubt != PlaceDoubt::kNone) return few ? too_few(*seen) : doubtful(*seen, doubt);
  return {seen->map == camera.map ? PlaceDecision::kClose : PlaceDecision::kJoin, *seen, *similarity};
}

}  // namespace coslam
