// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/map/map.h"

namespace coslam {

struct ClassifyConfig {
  bool enabled = true;
  int failures = 3;                // gate failures in succession of one camera's track that count
  int still_frames = 20;           // a dynamic point that stood so long is static again (paper: N_min)
  int test_frames = 30;            // newest of an unmapped track that are tested for motion; half of them at least
  double motion_px = 5.0;          // that it misses the best static point by, at 640 px image width
  double neighbour_share = 0.5;    // of the tracks around it that must move too
  double neighbour_radius = 0.06;  // of the larger image side
};

struct ClassifyReport {
  int uncertain = 0, dynamic = 0, removed = 0;  // changes of state in this set
  int stopped = 0;                              // dynamic to static
  int moving_tracks = 0;                        // unmapped ones that move, now
};

// What moves and what does not, every frame set (paper 5.4):
//   static -> uncertain: several cameras see the point elsewhere than predicted, `failures` sets in succession;
//   uncertain -> dynamic: this instant's observations of different cameras agree on one position; else the point is
//   false and removed;
//   dynamic: its position is that of this instant's observations; -> static when the present position explains where
//   its tracks were in the last `still_frames` frames.
// Unmapped tracks, and those of one camera alone, are told apart by the camera's own motion: a track that no static
// point explains, among others like it, is moving and is not mapped as static.
ClassifyReport classify(Map& map, const FrameSet& set, const ClassifyConfig& config);

}  // namespace coslam
