// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "server/estimator/map/keys.h"
#include "server/estimator/places/close_loop.h"
#include "server/estimator/places/key_image_database.h"

namespace coslam {

struct OfflineLoopsReport {
  int closed = 0;  // loops
  int linked = 0;  // images whose points became one with those of an earlier visit
  bool changed() const { return closed + linked > 0; }
};

// Without any camera at work: remembered images of one map that show a place of an earlier visit, which in the run came
// too late, too few or with points too young to be acted on. Where the map puts them right their points become one with
// the place's; where it does not the map is drawn together, once two images of different instants say the same of what
// is not flat, one of them by min_inliers points, or three together by twice as many.
OfflineLoopsReport close_loops_offline(PlaceRecognitionEdit& edit, const KeyImageDatabase& places, MapId of,
                                       int min_inliers, std::vector<LoopConstraint>* loops);

}  // namespace coslam
