// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/map/edit.h"
#include "server/motion/follow.h"

namespace coslam {

struct ClassifyConfig {
  bool enabled = true;
  double still_s = 0.2;      // what stood so long does not move now (the paper's N_min, 2 s, is too slow for people)
  double still_px_s = 4.0;   // apparent speed below which a thing stands, at 640 px image width
  double test_s = 1.0;       // newest part of an unmapped track that is tested for motion
  double least_s = 0.23;     // younger ones are not
  double doubtful_px = 3.0;  // that it misses every static explanation by, at 640 px image width: not mapped
  double motion_px = 5.0;    // the same, to be called moving
  double motion_parallax = 0.22;   // and at least so much of the parallax at the median depth
  double neighbour_share = 0.5;    // of the tracks around it that must move too
  double neighbour_radius = 0.06;  // of the larger image side
  FollowConfig follow;
};

template <class V>
void describe(V& v, ClassifyConfig& c) {
  v.field("enabled", c.enabled, "tell moving points from static ones");
  v.field("still_s", c.still_s, {0.01, 100}, "a moving point that stood so long is static again");
  v.field("still_px_s", c.still_px_s, {0, 1000}, "apparent speed below which a thing stands, at 640 px image width");
  v.field("least_s", c.least_s, {0.01, 10}, "age at which an unmapped track is tested for motion");
  v.field("test_s", c.test_s, {0.1, 10}, "newest part of an unmapped track that is tested for motion");
  v.field("doubtful_px", c.doubtful_px, {0.5, 50},
          "that it misses every static point by, at 640 px image width: it is not mapped");
  v.field("motion_px", c.motion_px, {0.5, 50}, "the same, to be called moving");
  v.field("motion_parallax", c.motion_parallax, {0, 10}, "and at least so much of the parallax at the median depth");
  v.field("neighbour_share", c.neighbour_share, {0, 1}, "of the tracks around it that must move too");
  v.field("neighbour_radius", c.neighbour_radius, {0, 1}, "of the larger image side");
}

struct ClassifyReport {
  int uncertain = 0, dynamic = 0, removed = 0;  // changes of state in this set
  int stopped = 0;                              // dynamic to static
  int rebound = 0;                              // further tracks of moving points
  int moving_tracks = 0;                        // unmapped ones that move, now

  void count(auto&& add) const {
    add("became_uncertain", uncertain);
    add("became_dynamic", dynamic);
    add("became_static", stopped);
    add("found_false", removed);
    add("rebound", rebound);
    add("moving_track_sets", moving_tracks);
  }
};

// What moves and what does not, every frame set (paper 5.4):
//   static -> uncertain: several cameras see the point elsewhere than predicted, `failures` sets in succession;
//   uncertain -> dynamic: this instant's observations of different cameras agree on one position; else the point is
//   false and removed;
//   dynamic: its position is that of this instant's observations (follow.h); -> static when its tracks did not move
//   against it in the last `still_s`. Poses rest on it only when it has proved itself again. A camera that
//   alone still sees it gives its track back when that stands still.
// Unmapped tracks, and those of one camera alone, are told apart by the camera's own motion: a track that no static
// point explains, among others like it, is moving and is not mapped as static.
ClassifyReport classify(MapEdit& edit, const FrameSet& set, const ClassifyConfig& config);

struct Classify {
  static constexpr std::string_view kName = "classify";
  using Config = ClassifyConfig;
  Config config;
  ClassifyReport run(MapEdit& edit, const FrameSet& set) const { return classify(edit, set, config); }
};

}  // namespace coslam
