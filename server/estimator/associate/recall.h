// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "server/estimator/map/map.h"

namespace coslam {

// Returns proven points of an earlier visit that these cameras may see now, though no camera saw them lately: a camera
// follows some points that were seen then, and the key frames that saw these, with those before and after them, saw
// more there. So a camera that returns to a place finds its points again and stays with them as it goes on, instead of
// mapping the place a second time. Sorted by id.
std::vector<const MapPoint*> points_of_earlier_visits(const Map& map, const std::vector<CameraId>& cameras);
// Returns points of earlier visits and the static points that were seen lately: all that these cameras may find again.
// Sorted by id.
std::vector<const MapPoint*> static_points_around(const Map& map, const std::vector<CameraId>& cameras);

}  // namespace coslam
