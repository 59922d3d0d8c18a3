// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/associate/pair_match.h"
#include "server/covisibility/group.h"
#include "server/map/edit.h"

namespace coslam {

struct MapInterConfig {
  int period = 5;  // frame sets between runs
  PairMatchConfig match;
  int check_back = 30;  // earlier frames in which the point must fit both tracks
};

template <class V>
void describe(V& v, MapInterConfig& c) {
  v.field("period", c.period, {1, 1000}, "frame sets between runs");
  v.field("seed_radius", c.match.seed_radius, {0, 1}, "phi_r, of the larger image side");
  v.field("disparity_gate", c.match.disparity_gate, {0, 100}, "phi_d over phi_r");
  v.field("check_back", c.check_back, {1, 1000}, "earlier frames in which the point must fit both tracks");
}

struct MapInterReport {
  PairMatchCounts pairs;
  int created = 0;

  void count(auto&& add) const {
    add("inter_matched", pairs.matched);
    add("created_inter", created);
  }
};

// New static points from unmapped tracks of two cameras that share an edge of the spanning tree (paper 5.2.2): epipolar
// band, patch correlation, disparity like that of the nearest shared point, mutual best; then the gate in both, now and
// back in time.
MapInterReport map_inter(MapEdit& edit, const FrameSet& set, const ViewGraph& graph, const MapInterConfig& config);

struct MapInter {
  static constexpr std::string_view kName = "map_inter";
  using Config = MapInterConfig;
  Config config;
  bool due(SetId now) const { return now.value % static_cast<std::uint32_t>(config.period) == 0; }
  MapInterReport run(MapEdit& edit, const FrameSet& set, const ViewGraph& graph) const {
    return map_inter(edit, set, graph, config);
  }
};

}  // namespace coslam
