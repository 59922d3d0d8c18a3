// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/simulation/gait.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace coslam::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kStepsPerWaypoint = 256;
constexpr double kDegree = std::numbers::pi / 180.0, kTurn = 2 * std::numbers::pi;
constexpr double kUsualStrideM = 1.3;

// Shares of a foot's cycle, which starts when its heel comes down.
constexpr double kFlat = 0.12, kHeelRises = 0.33, kToeLeaves = 0.62;
constexpr double kLandingRad = -18 * kDegree, kLeavingRad = 42 * kDegree;
// Where in the cycle the hips are above the ankle.
constexpr double kPassing = 0.23;
constexpr double kFootHalfM = 0.085;

std::vector<ViewPose> flat_poses(const std::vector<Vector2d>& waypoints) {
  std::vector<ViewPose> out;
  out.reserve(waypoints.size());
  for (const Vector2d& p : waypoints) out.push_back({{p.x(), p.y(), 0}, 0, 0, 0});
  return out;
}

double smooth(double x) {
  const double t = std::clamp(x, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

// The ankle over a footprint: ahead of its place, height, and pitch of the foot with the toe down.
using Ankle = Eigen::Vector3d;

Ankle turned_about(double pivot_m, double pitch_rad) {
  const double c = std::cos(pitch_rad), s = std::sin(pitch_rad);
  return {pivot_m - (pivot_m * c - kAnkleM * s), pivot_m * s + kAnkleM * c, pitch_rad};
}

// While the foot is on the floor.
Ankle standing(double u) {
  if (u < kFlat) return turned_about(kHeelM, kLandingRad * (1 - smooth(u / kFlat)));
  if (u < kHeelRises) return {0, kAnkleM, 0};
  const double rise = (u - kHeelRises) / (kToeLeaves - kHeelRises);
  return turned_about(kBallM, kLeavingRad * rise * rise);
}

double hermite(double a, double b, double slope_a, double slope_b, double x) {
  const double x2 = x * x, x3 = x2 * x;
  return a * (2 * x3 - 3 * x2 + 1) + slope_a * (x3 - 2 * x2 + x) + b * (3 * x2 - 2 * x3) + slope_b * (x3 - x2);
}

}  // namespace

GroundPath::GroundPath(const std::vector<Vector2d>& waypoints)
    : curve_(flat_poses(waypoints), static_cast<double>(waypoints.size())) {
  const auto steps = waypoints.size() * kStepsPerWaypoint;
  distance_m_.reserve(steps + 1);
  Vector3d last = curve_.at(0).position_m;
  for (std::size_t i = 0; i <= steps; ++i) {
    const Vector3d now = curve_.at(static_cast<double>(i) / kStepsPerWaypoint).position_m;
    length_m_ += (now - last).norm();
    distance_m_.push_back(length_m_);
    last = now;
  }
}

Vector2d GroundPath::at(double distance_m) const {
  const double d = distance_m - length_m_ * std::floor(distance_m / length_m_);
  const auto after = std::upper_bound(distance_m_.begin() + 1, distance_m_.end() - 1, d);
  const auto before = after - 1;
  const double share = (d - *before) / (*after - *before);
  const double step = static_cast<double>(before - distance_m_.begin()) + share;
  return curve_.at(step / kStepsPerWaypoint).position_m.head<2>();
}

double GroundPath::heading_rad(double distance_m) const {
  constexpr double kReachM = 0.17;
  const Vector2d way = at(distance_m + kReachM) - at(distance_m - kReachM);
  return std::atan2(way.y(), way.x());
}

Gait::Gait(GroundPath path)
    : path_(std::move(path)),
      stride_m_(path_.length_m() / std::max(1.0, std::round(path_.length_m() / kUsualStrideM))) {}

double Gait::rest_near(double distance_m) const {
  constexpr double kBothDown = 0.06;  // the heel is down, and the other toe has not left
  return stride_m_ * (0.5 * std::round(2 * (distance_m / stride_m_ - kBothDown)) + kBothDown);
}

// cycle: whole numbers are the landings of the foot.
Rigid3 Gait::foot(int side, double cycle) const {
  const double number = std::floor(cycle), u = cycle - number;
  const auto placed = [&](double footprint, const Ankle& ankle) {
    const double distance_m = (footprint + kPassing + 0.5 * side) * stride_m_;
    const double heading = path_.heading_rad(distance_m);
    const Vector2d ahead(std::cos(heading), std::sin(heading)), left(-ahead.y(), ahead.x());
    const Vector2d p = path_.at(distance_m) + ankle.x() * ahead + (side == 0 ? kFootHalfM : -kFootHalfM) * left;
    return Eigen::Vector4d(p.x(), p.y(), ankle.y(), heading);
  };
  const auto pose = [](const Eigen::Vector4d& place, double pitch_rad) {
    const Turn turn{place.w(), pitch_rad, 0};
    return Rigid3(turn.rotation(), place.head<3>());
  };
  if (u < kToeLeaves) {
    const Ankle ankle = standing(u);
    return pose(placed(number, ankle), ankle.z());
  }
  // Through the air, with the speed that it has on the floor at both ends.
  constexpr double kStep = 1e-4, kSwing = 1 - kToeLeaves;
  const Ankle a = standing(kToeLeaves - 1e-12), before = standing(kToeLeaves - kStep), b = standing(0),
              after = standing(kStep);
  const Eigen::Vector4d from = placed(number, a), to = placed(number + 1, b);
  const Eigen::Vector4d from_slope = (from - placed(number, before)) * (kSwing / kStep);
  const Eigen::Vector4d to_slope = (placed(number + 1, after) - to) * (kSwing / kStep);
  const double x = (u - kToeLeaves) / kSwing;
  Eigen::Vector4d place;
  for (int i = 0; i < 3; ++i) place(i) = hermite(from(i), to(i), from_slope(i), to_slope(i), x);
  place.w() = from.w() + smooth(x) * std::remainder(to.w() - from.w(), kTurn);
  const double pitch =
      hermite(a.z(), b.z(), (a.z() - before.z()) * (kSwing / kStep), (after.z() - b.z()) * (kSwing / kStep), x);
  return pose(place, pitch);
}

Posture Gait::at(double distance_m) const {
  const double cycle = distance_m / stride_m_, angle = kTurn * cycle;
  Posture out;
  const double sway_m = 0.02 * std::sin(angle), height_m = 0.893 - 0.022 * std::cos(2 * angle - 0.6);
  const double heading = path_.heading_rad(distance_m);
  const Vector2d left(-std::sin(heading), std::cos(heading)), middle = path_.at(distance_m) + sway_m * left;
  const Turn pelvis{heading - 5 * kDegree * std::cos(angle), 2 * kDegree, 3 * kDegree * std::sin(angle)};
  out.world_from_pelvis = Rigid3(pelvis.rotation(), {middle.x(), middle.y(), height_m});
  out.torso = {9 * kDegree * std::cos(angle), (2 + std::cos(2 * angle)) * kDegree, -4 * kDegree * std::sin(angle)};
  out.head = {-4 * kDegree * std::cos(angle), -(2 + 1.5 * std::cos(2 * angle)) * kDegree, 0};
  for (int side = 0; side < 2; ++side) {
    const double ahead = side == 0 ? -std::cos(angle) : std::cos(angle);  // each arm goes with the other leg
    out.arms[static_cast<std::size_t>(side)] = {(2 + 22 * ahead) * kDegree, 7 * kDegree, 10 * kDegree,
                                                (22 + 12 * ahead) * kDegree};
    out.world_from_feet[static_cast<std::size_t>(side)] = foot(side, cycle - 0.5 * side);
  }
  return out;
}

Walk::Walk(Gait gait, double speed_m_s, double start_m, const std::vector<Rest>& rests)
    : gait_(std::move(gait)), speed_m_s_(speed_m_s), start_m_(start_m) {
  double rested_s = 0;
  for (const Rest& rest : rests) {
    const double walked_s = (gait_.rest_near(start_m + rest.after_m) - start_m) / speed_m_s;
    const double from_s = walked_s + rested_s + kRampS / 2;
    stops_.push_back({from_s, from_s + rest.length_s});
    rested_s += rest.length_s + kRampS;
  }
}

double Walk::distance_m(double t_s) const {
  double walked_s = t_s;
  for (const Stop& stop : stops_) walked_s -= t_s - paused_time(t_s, stop.from_s, stop.to_s, kRampS);
  return start_m_ + speed_m_s_ * walked_s;
}

}  // namespace coslam::sim
