// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/simulation/motion.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "deploy/simulation/noise.h"

namespace coslam::sim {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

// Integral from 0 to x of the quintic step; 0.5 at x = 1.
double quintic_step_integral(double x) {
  if (x <= 0) return 0;
  if (x >= 1) return 0.5 + (x - 1);
  return x * x * x * x * (x * (x - 3.0) + 2.5);
}

}  // namespace

Rigid3 cam_from_world(const ViewPose& view) {
  const double h = view.heading_deg * kRadPerDeg, p = view.pitch_deg * kRadPerDeg;
  const Eigen::Vector3d forward(std::cos(h) * std::cos(p), std::sin(h) * std::cos(p), std::sin(p));
  const Eigen::Vector3d right(std::sin(h), -std::cos(h), 0);
  Eigen::Matrix3d world_from_cam;
  world_from_cam << right, forward.cross(right), forward;
  const Eigen::AngleAxisd roll(view.roll_deg * kRadPerDeg, Eigen::Vector3d::UnitZ());
  const Eigen::Quaterniond rotation(world_from_cam * roll);
  return Rigid3(rotation.normalized(), view.position_m).inverse();
}

LoopPath::LoopPath(const std::vector<ViewPose>& waypoints, double period_s) : period_s_(period_s) {
  const auto n = static_cast<Eigen::Index>(waypoints.size());
  Eigen::MatrixXd basis = Eigen::MatrixXd::Zero(n, n);
  Eigen::Matrix<double, Eigen::Dynamic, 6> values(n, 6);
  for (Eigen::Index i = 0; i < n; ++i) {
    const ViewPose& w = waypoints[static_cast<std::size_t>(i)];
    values.row(i) << w.position_m.transpose(), w.heading_deg, w.pitch_deg, w.roll_deg;
    basis(i, i) += 4.0 / 6.0;
    basis(i, (i + 1) % n) += 1.0 / 6.0;
    basis(i, (i + n - 1) % n) += 1.0 / 6.0;
  }
  control_ = basis.partialPivLu().solve(values);
}

ViewPose LoopPath::at(double t_s) const {
  const Eigen::Index n = control_.rows();
  const double turns = t_s / period_s_, x = (turns - std::floor(turns)) * static_cast<double>(n);
  const auto i = static_cast<Eigen::Index>(x);
  const double s = x - static_cast<double>(i), r = 1 - s;
  const double weights[4] = {r * r * r / 6, (3 * s * s * s - 6 * s * s + 4) / 6, (3 * r * r * r - 6 * r * r + 4) / 6,
                             s * s * s / 6};
  Row sum = Row::Zero();
  for (Eigen::Index k = 0; k < 4; ++k) sum += weights[k] * control_.row((i + k + n - 1) % n);
  return {sum.head<3>().transpose(), sum(3), sum(4), sum(5)};
}

namespace {

std::vector<ViewPose> without_turn(std::vector<ViewPose> waypoints, double turn_deg) {
  for (std::size_t i = 0; i < waypoints.size(); ++i) {
    waypoints[i].heading_deg -= turn_deg * static_cast<double>(i) / static_cast<double>(waypoints.size());
  }
  return waypoints;
}

}  // namespace

LoopPath there_and_back(const std::vector<ViewPose>& waypoints, double step_s) {
  std::vector<ViewPose> all = waypoints;
  for (std::size_t i = waypoints.size() - 2; i > 0; --i) all.push_back(waypoints[i]);
  return {all, step_s * static_cast<double>(all.size())};
}

ViewPath::ViewPath(std::vector<ViewPose> waypoints, double turn_deg)
    : turn_deg_(turn_deg), curve_(without_turn(std::move(waypoints), turn_deg), 1.0), step_(0) {
  constexpr int kSteps = 1 << 14;
  step_ = 1.0 / kSteps;
  distance_m_.push_back(0);
  Eigen::Vector3d last = curve_.at(0).position_m;
  for (int i = 1; i <= kSteps; ++i) {
    const Eigen::Vector3d now = curve_.at(i * step_).position_m;
    distance_m_.push_back(distance_m_.back() + (now - last).norm());
    last = now;
  }
}

ViewPose ViewPath::at(double distance_m) const {
  const double rounds = std::floor(distance_m / length_m()), d = distance_m - rounds * length_m();
  const auto after = std::upper_bound(distance_m_.begin() + 1, distance_m_.end() - 1, d);
  const auto before = after - 1;
  const double share = (static_cast<double>(before - distance_m_.begin()) + (d - *before) / (*after - *before)) * step_;
  ViewPose out = curve_.at(share);
  out.heading_deg += turn_deg_ * (rounds + share);
  return out;
}

double eased_journey(double t_s, double end_s, double rise_s) {
  return eased_start(t_s, rise_s) - eased_start(t_s - end_s + 2 * rise_s, rise_s);
}

double eased_start(double t_s, double rise_s) {
  if (t_s <= 0) return 0;
  return rise_s * 2 * quintic_step_integral(t_s / (2 * rise_s));
}

double eased_step(double t_s, double from_s, double to_s) {
  const double ramp = 0.25, x = (t_s - from_s) / (to_s - from_s);
  if (x <= 0) return 0;
  if (x >= 1) return 1;
  // Speed: up over one ramp, level, down over another; its integral is 1 - ramp.
  const double up = quintic_step_integral(x / ramp), down = quintic_step_integral((x - 1 + ramp) / ramp);
  return ramp * (up - down) / (1 - ramp);
}

double paused_time(double t_s, double from_s, double to_s, double ramp_s) {
  const double stopped =
      ramp_s * (quintic_step_integral((t_s - from_s + ramp_s) / ramp_s) - quintic_step_integral((t_s - to_s) / ramp_s));
  return t_s - stopped;
}

HandShake::HandShake(std::uint64_t seed, double translation_rms_m, double rotation_rms_deg) {
  Random random(seed);
  for (std::size_t axis = 0; axis < waves_.size(); ++axis) {
    const double rms = axis < 3 ? rotation_rms_deg * kRadPerDeg : translation_rms_m;
    for (std::size_t i = 0; i < kWaves; ++i) {
      // One wave a band from 1 to 4 Hz, so that every hand shakes in all of them; slower is stronger.
      const double hz = 1.0 + 0.75 * (static_cast<double>(i) + random.uniform(0, 1));
      const double share = 0.75 / std::sqrt(static_cast<double>(i + 1));
      waves_[axis][i] = {rms * share, 2 * std::numbers::pi * hz, random.uniform(0, 2 * std::numbers::pi)};
    }
  }
}

Rigid3 HandShake::at(double t_s) const {
  std::array<double, 6> sums{};
  for (std::size_t axis = 0; axis < sums.size(); ++axis) {
    for (const Wave& w : waves_[axis]) sums[axis] += w.amplitude * std::sin(w.omega_rad_s * t_s + w.phase_rad);
  }
  return {so3_exp({sums[0], sums[1], sums[2]}), {sums[3], sums[4], sums[5]}};
}

}  // namespace coslam::sim
