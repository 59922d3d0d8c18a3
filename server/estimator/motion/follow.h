// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "server/estimator/map/keys.h"
#include "server/estimator/map/sighting.h"

// Moving points, frame set by frame set: where they are, and which tracks are theirs.
namespace coslam {

struct FollowConfig {
  double neighbour_radius = 0.12;  // of the distance to the cameras: moving points so near move alike
  double forget_s = 2.0;           // without two cameras on it
  double forget_alone_s = 0.5;     // without neighbours either
  double search_px = 12.0;         // most between a track and where its point should be, at 640 px image width
};

struct FollowReport {
  int positioned = 0, carried = 0, removed = 0, unbound = 0, bound = 0;
};

// Triangulates every dynamic point from this instant. One that fewer than two cameras see is carried along with its
// moving neighbours, and keeps to its one ray. A track that disagrees with the others, or with where the point was
// carried, is let go.
FollowReport follow_moving(ClassifyEdit& edit, const FrameSet& set, const FollowConfig& config);

// Free tracks where a moving point should appear, and which look like it, are its further tracks: so it keeps its id
// when a track ends, is hidden for a moment, or begins in another camera.
void rebind_moving(ClassifyEdit& edit, const FrameSet& set, const FollowConfig& config, FollowReport* report);

// The path of a point that has begun to move, before this set: as far back as its tracks were at one place in each set,
// at most so many sets.
void record_past(MovingPathEdit& edit, const MapPoint& point, std::size_t most_sets);

}  // namespace coslam
