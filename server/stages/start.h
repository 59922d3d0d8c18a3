// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/map/map.h"
#include "server/solve/start.h"
#include "server/stages/localise.h"
#include "server/stages/refine.h"

namespace coslam {

struct StartStageConfig {
  StartConfig pair;
  LocaliseConfig localise;
  RefineConfig refine;
  int request_period = 10;     // frame sets between requests for descriptors while something is to be placed
  int alone_after_sets = 8;    // a camera without a map tries to start one from its own motion after so many sets
  double min_flow_px = 16;     // median displacement of its tracks for that, at 640 px image width
  int min_place_inliers = 20;  // to place a camera in a map by its descriptors
  int min_merge_inliers = 25;
};

struct StartReport {
  int started = 0, placed = 0, merged = 0;
  MapId merged_into;  // the last of them; 0 = none
  bool wants_descriptors = false;
  std::string reason;  // why a start failed
};

// Gets cameras into maps. Images of one instant with enough common view start one map together (paper: all see one
// scene); a camera that nobody can place starts a map of its own from its own motion, with a scale of its own; a camera
// whose descriptors fit another map is placed there, and if it came with a map of its own the two become one.
StartReport start(Map& map, const FrameSet& set, const StartStageConfig& config);

}  // namespace coslam
