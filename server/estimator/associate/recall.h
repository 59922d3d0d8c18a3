// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "server/estimator/map/map.h"

namespace coslam {

// Proven points of an earlier visit that these cameras may see now, though nobody saw them lately: a camera follows
// some points that were seen then, and the key frames that saw these, with those before and after them, saw more there.
// So whoever is back at a place finds all of it again and stays with it as he goes on, instead of making the map a
// second time, beside the first. Ascending ids.
std::vector<const MapPoint*> points_of_earlier_visits(const Map& map, const std::vector<CameraId>& cameras);
// These and the static ones that were seen lately: all that they may find again. Ascending ids.
std::vector<const MapPoint*> static_points_around(const Map& map, const std::vector<CameraId>& cameras);

}  // namespace coslam
