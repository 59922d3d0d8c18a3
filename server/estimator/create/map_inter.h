// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/estimator/associate/pair_match.h"
#include "server/estimator/covisibility/grouping.h"
#include "server/estimator/map/keys.h"

namespace coslam {

struct MapInterConfig {
  PairMatchConfig match;
};

template <class V>
void describe(V& v, MapInterConfig& c) {
  v.field("seed_radius", c.match.seed_radius, {0, 1}, "phi_r, of the larger image side");
  v.field("disparity_gate", c.match.disparity_gate, {0, 100}, "phi_d over phi_r");
}

struct MapInterReport {
  PairMatchCounts pairs;
  int created = 0;

  void count(auto&& add) const {
    add("inter_matched", pairs.matched);
    add("created_inter", created);
  }
};

// Creates static points from unmapped tracks of two cameras that share an edge of the spanning tree (paper 5.2.2):
// epipolar band, patch correlation, disparity like that of the nearest shared point, mutual best; then the gate in
// both, now and back in time.
MapInterReport map_inter(MapInterEdit& edit, const FrameSet& set, const ViewGraph& graph, const MapInterConfig& config);

struct MapInter {
  static constexpr std::string_view kName = "map_inter";
  using Config = MapInterConfig;
  Config config;
  bool due(const Map& map) const { return map.every(map.config().match_period_s); }
  MapInterReport run(MapInterEdit& edit, const FrameSet& set, const ViewGraph& graph) const {
    return map_inter(edit, set, graph, config);
  }
};

}  // namespace coslam
