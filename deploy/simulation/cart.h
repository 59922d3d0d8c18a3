// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>

#include "deploy/simulation/body.h"

namespace coslam::sim {

// A cart with boxes on four wheels, 0.9 x 0.5 x 1.0 m. It rolls along a straight line over the floor, from `start` in
// the direction of heading_deg; rolled_m tells how far. Part 0 is the cart, the others are the wheels.
Body make_cart(std::uint64_t seed, const Eigen::Vector2d& start, double heading_deg,
               std::function<double(double t_s)> rolled_m);

inline constexpr double kCartWheelM = 0.09;  // radius

}  // namespace coslam::sim
