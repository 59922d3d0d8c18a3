// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "server/estimator/associate/pair_match.h"
#include "server/estimator/map/map.h"

// The one judge of what moves and what rests: it answers from what cameras saw, and changes nothing. Who asks decides
// what becomes of the points and tracks: classify() of those that are there, map_moving() of new ones.
namespace coslam {

struct EvidenceConfig {
  double still_s = 0.2;      // what stood so long does not move now (the paper's N_min, 2 s, is too slow for people)
  double still_px_s = 4.0;   // apparent speed below which a thing stands, at 640 px image width
  double test_s = 1.0;       // newest part of an unmapped track that is tested for motion
  double least_s = 0.23;     // younger ones are not
  double doubtful_px = 3.0;  // that it misses every static explanation by, at 640 px image width: not mapped
  double motion_px = 5.0;    // the same, to be called moving
  double motion_parallax = 0.22;  // and at least so much of the parallax at the median depth
  double neighbour_share = 0.5;   // of the tracks around it that must move too
};

template <class V>
void describe(V& v, EvidenceConfig& c) {
  v.field("still_s", c.still_s, {0.01, 100}, "a moving point that stood so long is static again");
  v.field("still_px_s", c.still_px_s, {0, 1000}, "apparent speed below which a thing stands, at 640 px image width");
  v.field("least_s", c.least_s, {0.01, 10}, "age at which an unmapped track is tested for motion");
  v.field("test_s", c.test_s, {0.1, 10}, "newest part of an unmapped track that is tested for motion");
  v.field("doubtful_px", c.doubtful_px, {0.5, 50},
          "that it misses every static point by, at 640 px image width: it is not mapped");
  v.field("motion_px", c.motion_px, {0.5, 50}, "the same, to be called moving");
  v.field("motion_parallax", c.motion_parallax, {0, 10}, "and at least so much of the parallax at the median depth");
  v.field("neighbour_share", c.neighbour_share, {0, 1}, "of the tracks around it that must move too");
}

// Tracks so near each other in an image are taken for neighbours on one thing, of the larger image side.
inline constexpr double kNeighbours = 0.06;

// A static point: at least two cameras see it elsewhere than predicted in this set, so it is not one of their tracks
// that slid.
bool seen_elsewhere(const Map& map, const MapPoint& point);

// A moving point: it has not moved against its tracks lately, in at least two cameras.
bool stands_still(const Map& map, const MapPoint& point, const EvidenceConfig& config);

// Of what stands still in the camera's view; 0 = unknown.
double median_static_depth(const Map& map, const MapCamera& camera);
// What the camera's track saw lately may have been at rest, at whatever distance. False when it is too young to tell.
bool may_rest(const MapCamera& camera, const ServerTrack& track, double median_depth, const EvidenceConfig& config);

// What one camera's own motion says of a track that has no point: it moves when no static place explains its newest
// views, and its neighbours do the same.
struct TrackJudgement {
  const ServerTrack* track = nullptr;
  TrackMotion motion = TrackMotion::kResting;
  int moving_neighbours = 0, resting_neighbours = 0;  // counted where it is another motion than before
  // What began to show that it moves, and went along with the camera before, as the car ahead does: since then. On a
  // straight way nothing tells such a thing from one infinitely far, until it turns.
  std::optional<SetId> co_moving_since;
};
std::vector<TrackJudgement> judge_tracks(const Map& map, const MapCamera& camera, const EvidenceConfig& config);

// The two tracks were one place at every instant of the last back_s, and that place moved: what one camera sees to
// move, another may take for a thing at rest, nearer or farther away.
bool moved_as_one(const Map& map, const PairView& view, const Feature& a, const Feature& b, double back_s);

}  // namespace coslam
