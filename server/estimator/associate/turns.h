// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "server/estimator/map/map.h"

namespace coslam {

// Returns the cameras that may look for points of others in this round. The number of findable points grows with the
// number of cameras, so that the work of all would grow with its square: of more than kAllLook cameras each waits for
// its turn, and as many look in each round.
constexpr std::size_t kAllLook = 8;
std::vector<CameraId> cameras_in_turn(const FrameSet& set, std::uint32_t round);

}  // namespace coslam
