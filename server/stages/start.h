// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/map/edit.h"
#include "server/solve/start.h"
#include "server/stages/localise.h"
#include "server/stages/refine.h"

namespace coslam {

struct StartStageConfig {
  StartConfig pair;
  LocaliseConfig localise;
  RefineConfig refine;
  int alone_after_sets = 8;  // a camera without a map tries to start one from its own motion after so many sets
  double min_flow_px = 16;   // median displacement of its tracks for that, at 640 px image width
};

struct StartReport {
  int started = 0;
  std::string reason;  // why a start failed
};

// Starts maps. Images of one instant with enough common view start one together (paper: all see one scene); a camera
// that stays alone starts a map of its own from its own motion, with a scale of its own. How they join: meet.h.
StartReport start(MapEdit& edit, const FrameSet& set, const StartStageConfig& config);

}  // namespace coslam
