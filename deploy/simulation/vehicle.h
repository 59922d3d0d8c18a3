// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "deploy/simulation/body.h"

// Vehicles on a street. Lengths in metres.
namespace coslam::sim {

// Place on the ground; the heading is counter-clockwise from +x.
struct RoadPlace {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  double heading_rad = 0;
  double rolled_m = 0;  // turns the wheels
};
using RoadMotion = std::function<RoadPlace(double t_s)>;

inline constexpr double kCarHalfLengthM = 2.1, kCarHalfWidthM = 0.88;

// The origin of a car is on the ground below its middle; part 0 is the car, the others are the wheels.
Body make_car(std::uint64_t seed, RoadMotion motion);
// Somebody on a bicycle, pedalling.
Body make_cyclist(std::uint64_t seed, RoadMotion motion);

// The way that a car has gone which starts from rest at t = 0, speeds up and brakes by at most accelerate_m_s2, and is
// nowhere faster than limit_m_s(way). C1.
class Drive {
 public:
  Drive(const std::function<double(double way_m)>& limit_m_s, double accelerate_m_s2, double end_s);
  // 0 before it starts; after end_s it goes on with the last speed.
  double way_m(double t_s) const;

 private:
  static constexpr double kStepS = 0.01;
  std::vector<double> way_m_, speed_m_s_;  // at each step
};

}  // namespace coslam::sim
