// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/map/edit.h"

namespace coslam {

struct FuseConfig {
  int period = 5;       // frame sets between runs
  int check_back = 60;  // frames of each track in which the fused point must fit
};

template <class V>
void describe(V& v, FuseConfig& c) {
  v.field("period", c.period, {1, 1000}, "frame sets between runs");
  v.field("check_back", c.check_back, {1, 1000}, "frames of each track in which the fused point must fit");
}

struct FuseReport {
  int candidates = 0, fused = 0;

  void count(auto&& add) const {
    add("fuse_candidates", candidates);
    add("fused", fused);
  }
};

// Two cameras that map the same corner by themselves make two points of it. Such a pair becomes one when no camera ever
// saw both at once, one projects onto the other's track within theta of both uncertainties, their patches correlate,
// and one position explains every view of either: these links between cameras hold the map together.
FuseReport fuse_points(MapEdit& edit, const FrameSet& set, const FuseConfig& config);

struct Fuse {
  static constexpr std::string_view kName = "fuse";
  using Config = FuseConfig;
  Config config;
  bool due(SetId now) const { return now.value % static_cast<std::uint32_t>(config.period) == 0; }
  FuseReport run(MapEdit& edit, const FrameSet& set) const { return fuse_points(edit, set, config); }
};

}  // namespace coslam
