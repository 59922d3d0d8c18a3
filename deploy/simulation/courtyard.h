// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "deploy/simulation/world.h"

namespace coslam::sim {

// Houses around a way that goes around two houses in the middle. In the middle of each long side (along x) of the way
// another house divides it into two lanes, with a gate at both ends of each. Lengths in metres.
struct CourtyardPlan {
  double straight_x_m = 0, straight_y_m = 0;  // straight parts of the way, a rectangle with round corners
  double start_y_m = 0;                       // start of the way: on the west side, going south

  static constexpr double kCornerM = 4.5;
  static constexpr double kHalfWayM = 5.0;  // distance from the middle of the way to the houses inside and outside
  static constexpr double kLaneM = 2.9;     // distance from the middle of the way to that of a lane
  double way_x() const { return straight_x_m / 2 + kCornerM; }  // half of the sides
  double way_y() const { return straight_y_m / 2 + kCornerM; }
  double inner_x() const { return way_x() - kHalfWayM; }
  double inner_y() const { return way_y() - kHalfWayM; }
  double outer_x() const { return way_x() + kHalfWayM; }
  double outer_y() const { return way_y() + kHalfWayM; }
  double way_length_m() const;
};

World courtyard_world(const CourtyardPlan& plan, std::uint64_t seed);

// A place on the way, counter-clockwise.
struct WayPlace {
  Eigen::Vector2d at, outward;
  double heading_deg = 0;  // goes on beyond 360
};
WayPlace way_place(const CourtyardPlan& plan, double gone_m);

// 1 between the gates of the south (side -1) or north (+1) side, 0 away from them, smooth between.
double in_lanes(const CourtyardPlan& plan, const WayPlace& place, double side);

}  // namespace coslam::sim
