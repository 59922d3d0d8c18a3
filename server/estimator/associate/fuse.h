// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/base/workers.h"
#include "server/estimator/map/keys.h"
#include "server/estimator/pipeline/stage.h"

namespace coslam {

struct FuseReport {
  int candidates = 0, fused = 0;

  void count(auto&& add) const {
    add("fuse_candidates", candidates);
    add("fused", fused);
  }
};

// Fuses points that two cameras mapped separately from the same corner. Two points become one when no camera ever saw
// both at once, one projects onto the other's track within theta of both uncertainties, their patches correlate, and
// one position explains every view of either: these links between cameras hold the map together.
FuseReport fuse_points(FuseEdit& edit, const FrameSet& set, Workers& workers = Workers::alone());

struct Fuse {
  static constexpr std::string_view kName = "fuse";
  using Config = NoConfig<Fuse>;
  Config config;
  bool due(const Map& map) const { return map.every(map.config().match_period_s); }
  FuseReport run(FuseEdit& edit, const FrameSet& set, Workers& workers) const {
    return fuse_points(edit, set, workers);
  }
};

}  // namespace coslam
