// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "deploy/simulation/motion.h"
#include "deploy/simulation/person.h"

namespace coslam::sim {

// A closed path on the floor, by the distance walked on it. Smooth where the waypoints are not too close to each other.
class GroundPath {
 public:
  explicit GroundPath(const std::vector<Eigen::Vector2d>& waypoints);
  double length_m() const { return length_m_; }
  Eigen::Vector2d at(double distance_m) const;
  // Direction of the path ahead, counter-clockwise from +x, in (-pi, pi]; taken over a third of a metre.
  double heading_rad(double distance_m) const;

 private:
  std::vector<double> distance_m_;  // at equal steps of the curve's parameter
  LoopPath curve_;
  double length_m_ = 0;
};

// The posture of somebody who has walked a distance on a path. A foot stands still on the floor from heel to toe and
// swings to where the path will be a stride later; the body only depends on the distance, so that somebody who does not
// move on is still.
class Gait {
 public:
  // The stride (two steps) is near 1.3 m, and such that a whole number of them makes the path.
  explicit Gait(GroundPath path);
  const GroundPath& path() const { return path_; }
  double stride_m() const { return stride_m_; }
  // The nearest distance at which both feet are on the floor.
  double rest_near(double distance_m) const;
  Posture at(double distance_m) const;

 private:
  Rigid3 foot(int side, double cycle) const;

  GroundPath path_;
  double stride_m_;
};

struct Rest {
  double after_m = 0;  // walked since the start; moved to the nearest place where both feet are on the floor
  double length_s = 0;
};

// Walk of a person at a steady speed with rests now and then.
class Walk {
 public:
  // rests: in the order of the way. start_m: where on the path at t = 0.
  Walk(Gait gait, double speed_m_s, double start_m, const std::vector<Rest>& rests);
  double distance_m(double t_s) const;
  Posture at(double t_s) const { return gait_.at(distance_m(t_s)); }

 private:
  static constexpr double kRampS = 0.5;
  struct Stop {
    double from_s, to_s;
  };
  Gait gait_;
  double speed_m_s_, start_m_;
  std::vector<Stop> stops_;
};

}  // namespace coslam::sim
