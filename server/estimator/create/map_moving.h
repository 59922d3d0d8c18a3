// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/estimator/associate/pair_match.h"
#include "server/estimator/covisibility/grouping.h"
#include "server/estimator/create/map_inter.h"
#include "server/estimator/map/keys.h"

namespace coslam {

struct MapMovingConfig {
  double period_s = 0.067;     // time between runs
  double check_back_s = 0.33;  // time over which two tracks of a moving thing must be at one place
};

template <class V>
void describe(V& v, MapMovingConfig& c) {
  v.field("period_s", c.period_s, {0.001, 10}, "between runs");
  v.field("check_back_s", c.check_back_s, {0.01, 10}, "in which two tracks of a moving thing must have met");
}

struct MapMovingReport {
  PairMatchCounts pairs;
  int joined = 0;  // pairs of tracks

  void count(auto&& add) const { add("joined_moving", joined); }
};

// Joins tracks of moving things, matched like static ones between any two cameras that see the same, when they were at
// one place at each of the last instants; the position is triangulated from one instant alone. One of the two cameras
// may not have detected by itself that its track moves: then that place must have moved, in both images.
MapMovingReport map_moving(MapMovingEdit& edit, const FrameSet& set, const ViewGraph& graph,
                           const PairMatchConfig& match, const MapMovingConfig& config);

struct MapMoving {
  static constexpr std::string_view kName = "map_moving";
  using Config = MapMovingConfig;
  Config config;
  bool due(const Map& map) const { return map.every(config.period_s); }
  MapMovingReport run(MapMovingEdit& edit, const FrameSet& set, const ViewGraph& graph,
                      const MapInterConfig& inter) const {
    return map_moving(edit, set, graph, inter.match, config);
  }
};

}  // namespace coslam
