// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "deploy/simulation/simulated_scene.h"

namespace coslam::sim {

// Places spread over the open surfaces of all bodies, about as many on each. Empty when nothing can move. The same seed
// gives the same places.
std::vector<SurfaceSpot> marked_spots(const SimulatedScene& scene, int count, std::uint64_t seed);

}  // namespace coslam::sim
