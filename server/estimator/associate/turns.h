// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "server/estimator/map/map.h"

namespace coslam {

// Which cameras look for what others have mapped. What there is to be found goes with their number, so that all of them
// together would take its square: of more than kAllLook each waits for its turn, and as many look at each round.
constexpr std::size_t kAllLook = 8;
std::vector<CameraId> cameras_in_turn(const FrameSet& set, std::uint32_t round);

}  // namespace coslam
