// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "common/geometry/rigid3.h"

namespace coslam::sim {

// World: z up. heading counter-clockwise from +x; pitch up.
struct ViewPose {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  double heading_deg = 0, pitch_deg = 0, roll_deg = 0;
};

Rigid3 cam_from_world(const ViewPose& view);

// A closed path through waypoints that are passed at equal times: periodic cubic interpolation, C2.
class LoopPath {
 public:
  LoopPath(const std::vector<ViewPose>& waypoints, double period_s);
  ViewPose at(double t_s) const;

 private:
  using Row = Eigen::Matrix<double, 1, 6>;
  double period_s_;
  Eigen::Matrix<double, Eigen::Dynamic, 6> control_;  // uniform cubic B-spline
};

// Path through waypoints that are step_s apart and back the same way, at rest at both ends.
LoopPath there_and_back(const std::vector<ViewPose>& waypoints, double step_s);

// A closed path with the view at each place, by the distance gone on it.
class ViewPath {
 public:
  // Waypoints about equally far apart. turn_deg: what the heading gains around the path.
  ViewPath(std::vector<ViewPose> waypoints, double turn_deg);
  double length_m() const { return distance_m_.back(); }
  ViewPose at(double distance_m) const;

 private:
  double turn_deg_;
  LoopPath curve_;  // heading that remains when the turn is taken out evenly
  double step_;     // step of the curve's parameter between two of distance_m_
  std::vector<double> distance_m_;
};

// Time that runs at speed 1 in the long run, and starts from rest at t = 0: C2 for t > 0.
double eased_start(double t_s, double rise_s);
// Time that starts from rest at t = 0, and comes to rest at end_s, having run for end_s - 2 rise_s.
double eased_journey(double t_s, double end_s, double rise_s);
// 0 before `from`, 1 after `to`, with constant speed between C2 ramps that take a quarter of the time each.
double eased_step(double t_s, double from_s, double to_s);
// Integral of 1 - bump, where bump rises to 1 in ramp_s around [from, to]: time that stands still in between. C2.
double paused_time(double t_s, double from_s, double to_s, double ramp_s);

// The tremor of a hand: a sum of sines between 1 and 4 Hz a degree of freedom.
class HandShake {
 public:
  HandShake(std::uint64_t seed, double translation_rms_m, double rotation_rms_deg);
  // The camera with shake, from the camera without.
  Rigid3 at(double t_s) const;

 private:
  static constexpr int kWaves = 4;
  struct Wave {
    double amplitude = 0, omega_rad_s = 0, phase_rad = 0;
  };
  std::array<std::array<Wave, kWaves>, 6> waves_;
};

}  // namespace coslam::sim
