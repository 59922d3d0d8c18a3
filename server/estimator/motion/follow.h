// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "server/estimator/map/keys.h"
#include "server/estimator/map/sighting.h"

// Follows moving points from frame set to frame set: their positions, and which tracks are no longer theirs.
namespace coslam {

// Extent of what moves as one, as a share of its distance from the cameras, and of the image's width.
inline constexpr double kOneThing = 0.12;

struct FollowConfig {
  double neighbour_radius = kOneThing;  // share of the distance: moving points closer than this move alike
  double forget_s = 2.0;                // time without two cameras on it after which a moving point is removed
  double forget_alone_s = 0.5;  // time without two cameras and without neighbours after which a moving point is removed
  double search_px = 12.0;      // largest distance of a track from where its point should be, at 640 px image width
};

struct FollowReport {
  int positioned = 0, carried = 0, removed = 0, unbound = 0, bound = 0;
};

// Triangulates every dynamic point from this instant. One that fewer than two cameras see is carried along with its
// moving neighbours, and stays on its one ray. A track that disagrees with the others, or with where the point was
// carried, is unbound.
FollowReport follow_moving(ClassifyEdit& edit, const FrameSet& set, const FollowConfig& config);

// Records the path of a point that has begun to move, before this set: as far back as its tracks were at one place in
// each set, at most most_sets.
void record_past(MovingPathEdit& edit, const MapPoint& point, std::size_t most_sets);

}  // namespace coslam
