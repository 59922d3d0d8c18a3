// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/map/edit.h"

namespace coslam {

struct CullConfig {
  int probation_sets = 30;  // a new point must have been seen well by then
  int min_views = 12;       // frames in which it passed the gate during probation
};

struct CullReport {
  int removed = 0;
};

// Removes points that turned out to be false, and thins what old points carry, so that memory stays bounded.
CullReport cull(MapEdit& edit, const FrameSet& set, const CullConfig& config);

}  // namespace coslam
