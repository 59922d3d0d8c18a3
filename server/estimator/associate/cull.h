// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/estimator/map/keys.h"

namespace coslam {

struct CullConfig {
  double probation_s = 1.0;  // age by which a new point that no track follows must have been seen well
  double min_seen = 0.4;     // share of the frame sets of that time in which it passed the gate
};

template <class V>
void describe(V& v, CullConfig& c) {
  v.field("probation_s", c.probation_s, {0.01, 1000}, "by when a new point must have been seen well");
  v.field("min_seen", c.min_seen, {0, 1}, "of the frame sets of that time, in which it passed the gate");
}

struct CullReport {
  int removed = 0;

  void count(auto&& add) const { add("culled", removed); }
};

// Removes points that turned out to be false, and thins the patches of old points, so that memory stays bounded.
CullReport cull(CullEdit& edit, const FrameSet& set, const CullConfig& config);

struct Cull {
  static constexpr std::string_view kName = "cull";
  using Config = CullConfig;
  Config config;
  CullReport run(CullEdit& edit, const FrameSet& set) const { return cull(edit, set, config); }
};

}  // namespace coslam
