// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "server/estimator/map/map.h"

namespace coslam {

using Poses = std::vector<ImageKey>;

// Older poses that see the window's points: the most connected, and those that share most with each camera. Cameras
// that are back at a place share more with who mapped it than others do with their own last poses, and a part of the
// window that few points hold goes where it likes.
Poses holding_poses(const Map& map, MapId of, SetId first, std::size_t most);

}  // namespace coslam
