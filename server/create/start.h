// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/adjust/refine.h"
#include "server/map/edit.h"
#include "server/pose/localise.h"
#include "server/solve/start.h"

namespace coslam {

struct StartStageConfig {
  StartConfig pair;
  double alone_after_s = 0.27;  // a camera without a map tries to start one from its own motion after so long
  double min_flow_px = 16;      // median displacement of its tracks for that, at 640 px image width
};

template <class V>
void describe(V& v, StartStageConfig& c) {
  v.field("min_matches", c.pair.min_matches, {10, 1000}, "between two cameras that start a map together");
  v.field("min_parallax_rad", c.pair.min_parallax_rad, {0.001, 1}, "median over their points");
  v.field("alone_after_s", c.alone_after_s, {0, 1000},
          "after so long a camera that nobody placed starts a map of its own");
  v.field("min_flow_px", c.min_flow_px, {1, 200}, "median displacement of its tracks for that, at 640 px image width");
}

struct StartReport {
  int started = 0;
  std::string reason;  // why a start failed

  void count(auto&& add) const { add("maps_started", started); }
};

// Starts maps. Images of one instant with enough common view start one together (paper: all see one scene); a camera
// that stays alone starts a map of its own from its own motion, with a scale of its own. How they join: meet.h.
StartReport start(MapEdit& edit, const FrameSet& set, const StartStageConfig& config, const LocaliseConfig& localise,
                  const RefineConfig& refine);

struct Start {
  static constexpr std::string_view kName = "start";
  using Config = StartStageConfig;
  Config config;
  StartReport run(MapEdit& edit, const FrameSet& set, const LocaliseConfig& localise,
                  const RefineConfig& refine) const {
    return start(edit, set, config, localise, refine);
  }
};

}  // namespace coslam
