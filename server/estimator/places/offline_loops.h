// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "server/estimator/map/keys.h"
#include "server/estimator/places/close_loop.h"
#include "server/estimator/places/key_image_database.h"

namespace coslam {

struct OfflineLoopsReport {
  int closed = 0;  // closed loops
  int linked = 0;  // images whose points were fused with those of an earlier visit
  bool changed() const { return closed + linked > 0; }
};

// Closes loops without any camera running: by remembered images of one map that show a place of an earlier visit, which
// in the run came too late, too few or with points too young to be used. Where the map is right about them their points
// are fused with the place's; where it is not a loop is closed, once two images of different instants agree and show
// more than a plane, one of them by min_inliers points, or three together by twice as many.
OfflineLoopsReport close_loops_offline(PlaceRecognitionEdit& edit, const KeyImageDatabase& places, MapId map_id,
                                       int min_inliers, std::vector<LoopConstraint>* loops);

}  // namespace coslam
