// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/stages/map_inter.h"

namespace coslam {

// Tracks of moving things, matched in the same way between any two cameras that see the same, and joined when they were
// at one place at each of the last instants; where that was is triangulated from one instant alone. One of the two
// cameras may not have found out by itself that its track moves: then that place must have moved, in both images.
MapInterReport map_moving(MapEdit& edit, const FrameSet& set, const ViewGraph& graph, const MapInterConfig& config);

}  // namespace coslam
