// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/map/edit.h"

namespace coslam {

struct CullConfig {
  int probation_sets = 30;  // a new point must have been seen well by then
  int min_views = 12;       // frames in which it passed the gate during probation
};

template <class V>
void describe(V& v, CullConfig& c) {
  v.field("probation_sets", c.probation_sets, {1, 10000}, "by when a new point must have been seen well");
  v.field("min_views", c.min_views, {1, 10000}, "frames in which it passed the gate by then");
}

struct CullReport {
  int removed = 0;

  void count(auto&& add) const { add("culled", removed); }
};

// Removes points that turned out to be false, and thins what old points carry, so that memory stays bounded.
CullReport cull(MapEdit& edit, const FrameSet& set, const CullConfig& config);

struct Cull {
  static constexpr std::string_view kName = "cull";
  using Config = CullConfig;
  Config config;
  CullReport run(MapEdit& edit, const FrameSet& set) const { return cull(edit, set, config); }
};

}  // namespace coslam
