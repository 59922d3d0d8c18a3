// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/estimator/map/keys.h"

namespace coslam {

struct FinalPosesReport {
  int solved = 0;   // frames that could be solved again
  int changed = 0;  // solved frames that were far off
  int placed = 0;   // frames that had no pose
};

// Refines the poses of all frames after the last adjustment: solves each frame of a map again from what it saw of the
// points as they are now, also by tracks that had no point yet when it was taken. A pose that is farther off than both
// solutions may be takes the new one: adjustments carry frames between key frames along, and a live pose that was wrong
// stays wrong. A frame without a pose beside one that has one is placed in the same way.
FinalPosesReport refine_final_poses(LateFrameEdit& edit, MapId map_id);
// Refines the poses of one camera's frames from one set to before another, in whatever map they are, that are about to
// leave memory.
FinalPosesReport refine_final_poses(LateFrameEdit& edit, const MapCamera& camera, SetId from, SetId before);

}  // namespace coslam
