// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "server/estimator/associate/pair_match.h"
#include "server/estimator/map/map.h"

// Judges, in one place for all stages, what moves and what rests: from what cameras saw, and without changing anything.
// Its callers decide what becomes of the points and tracks: classify() for existing ones, map_moving() for new ones.
namespace coslam {

struct EvidenceConfig {
  double still_s =
      0.2;  // time at rest after which a thing is not moving (the paper's N_min, 2 s, is too slow for people)
  double still_px_s = 4.0;        // apparent speed below which a thing stands, at 640 px image width
  double test_s = 1.0;            // newest part of an unmapped track that is tested for motion
  double least_s = 0.23;          // least age of a track that is tested
  double doubtful_px = 3.0;       // miss of every static place, at 640 px image width, from which a track is not mapped
  double motion_px = 5.0;         // miss of every static place, at 640 px image width, from which a track is moving
  double motion_parallax = 0.22;  // least miss of a moving track, as a share of the parallax at the median depth
  double neighbour_share = 0.5;   // least share of the tracks around a moving track that move too
};

template <class V>
void describe(V& v, EvidenceConfig& c) {
  v.field("still_s", c.still_s, {0.01, 100}, "a moving point that stood so long is static again");
  v.field("still_px_s", c.still_px_s, {0, 1000}, "apparent speed below which a thing stands, at 640 px image width");
  v.field("doubtful_px", c.doubtful_px, {0.5, 50},
          "that it misses every static point by, at 640 px image width: it is not mapped");
  v.field("motion_px", c.motion_px, {0.5, 50}, "the same, to be called moving");
  v.field("motion_parallax", c.motion_parallax, {0, 10}, "and at least so much of the parallax at the median depth");
}

// Distance in an image, as a share of the larger image side, up to which tracks count as neighbours on one thing.
inline constexpr double kNeighbours = 0.06;

// Tells of a static point whether at least two cameras see it elsewhere than predicted in this set, so that it is not
// one of their tracks that slid.
bool seen_elsewhere(const Map& map, const MapPoint& point);

// Tells of a moving point whether it has not moved against its tracks lately, in at least two cameras.
bool stands_still(const Map& map, const MapPoint& point, const EvidenceConfig& config);

// Median depth of the static points in the camera's view; 0 = unknown.
double median_static_depth(const Map& map, const MapCamera& camera);
// Tells whether a track's newest observations are consistent with a thing at rest, at whatever distance. False when the
// track is too young to tell.
bool may_rest(const MapCamera& camera, const ServerTrack& track, double median_depth, const EvidenceConfig& config);

// Judgement of a track without a point by one camera's own motion: it moves when no static place explains its newest
// views, and its neighbours do the same.
struct TrackJudgement {
  const ServerTrack* track = nullptr;
  TrackMotion motion = TrackMotion::kResting;
  int moving_neighbours = 0, resting_neighbours = 0;  // counted when the motion differs from before
  // Start of the time in which the track's thing went along with the camera, as the car ahead does; set when it begins
  // to show that it moves. On a straight way such a thing looks like one infinitely far, until it turns.
  std::optional<SetId> co_moving_since;
};
std::vector<TrackJudgement> judge_tracks(const Map& map, const MapCamera& camera, const EvidenceConfig& config);

// Tells whether two tracks were one place at every instant of the last back_s, and that place moved: what one camera
// sees as moving, another may take for a thing at rest, nearer or farther away.
bool moved_as_one(const Map& map, const PairView& view, const Feature& a, const Feature& b, double back_s);

}  // namespace coslam
