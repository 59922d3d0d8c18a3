// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "server/estimator/map/map.h"

namespace coslam {

using Poses = std::vector<ImageKey>;

// Selects older poses that see the window's points, to hold it: the most connected, and those that share most with each
// camera. Cameras that are back at a place share more with the camera that mapped it than others do with their own last
// poses, and a part of the window that few points hold drifts freely.
Poses holding_poses(const Map& map, MapId map_id, SetId first, std::size_t most);

}  // namespace coslam
