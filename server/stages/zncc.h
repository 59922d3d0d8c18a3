// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/map/map.h"

namespace coslam {

// Zero-mean normalised cross correlation of two patches, -1 to 1; 0 for a flat patch.
double zncc(const PatchGrey& a, const PatchGrey& b);

// Whether the two are centred on the same thing: the peak of their correlation lies within a pixel or so of the image
// (0.4 of the patch's, which are 3.3 times as large). Corners that two cameras found on one structure often do not.
bool same_centre(const PatchGrey& a, const PatchGrey& b);

// The patch of a point seen from the direction nearest to this one; null when it has none.
const PointPatch* nearest_patch(const MapPoint& point, const Eigen::Vector3d& view_direction);

}  // namespace coslam
