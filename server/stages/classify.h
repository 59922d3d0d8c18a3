// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/map/edit.h"
#include "server/stages/follow.h"

namespace coslam {

struct ClassifyConfig {
  bool enabled = true;
  int failures = 3;          // gate failures in succession of one camera's track that count
  int still_frames = 6;      // what stood so long does not move now (the paper's N_min, 60, is too slow for people)
  double still_px_s = 4.0;   // apparent speed below which a thing stands, at 640 px image width
  int test_frames = 30;      // newest of an unmapped track that are tested for motion
  int least_frames = 7;      // younger ones are not
  double doubtful_px = 3.0;  // that it misses every static explanation by, at 640 px image width: not mapped
  double motion_px = 5.0;    // the same, to be called moving
  double motion_parallax = 0.22;   // and at least so much of the parallax at the median depth
  double neighbour_share = 0.5;    // of the tracks around it that must move too
  double neighbour_radius = 0.06;  // of the larger image side
  FollowConfig follow;
};

struct ClassifyReport {
  int uncertain = 0, dynamic = 0, removed = 0;  // changes of state in this set
  int stopped = 0;                              // dynamic to static
  int rebound = 0;                              // further tracks of moving points
  int moving_tracks = 0;                        // unmapped ones that move, now
};

// What moves and what does not, every frame set (paper 5.4):
//   static -> uncertain: several cameras see the point elsewhere than predicted, `failures` sets in succession;
//   uncertain -> dynamic: this instant's observations of different cameras agree on one position; else the point is
//   false and removed;
//   dynamic: its position is that of this instant's observations (follow.h); -> static when its tracks did not move
//   against it in the last `still_frames` frames. Poses rest on it only when it has proved itself again. A camera that
//   alone still sees it gives its track back when that stands still.
// Unmapped tracks, and those of one camera alone, are told apart by the camera's own motion: a track that no static
// point explains, among others like it, is moving and is not mapped as static.
ClassifyReport classify(MapEdit& edit, const FrameSet& set, const ClassifyConfig& config);

}  // namespace coslam
