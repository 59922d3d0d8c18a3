// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "server/estimator/map/map.h"

namespace coslam {

// Tells whether some of these points stand off the plane through most of them, by more than their standard deviations
// allow: flat things, like posters, exist in many copies.
bool has_relief(const std::vector<const MapPoint*>& points, double median_depth);

// Tells whether the points extend so far that, flat or not, no print does: several times the farthest distance from
// which an image showed them in one direction, and half of it in the other, with many points. Typical of ground seen
// from aircraft. That it does not repeat itself is to be checked separately.
bool covers_ground(const std::vector<const MapPoint*>& points, double farthest_depth);

}  // namespace coslam
