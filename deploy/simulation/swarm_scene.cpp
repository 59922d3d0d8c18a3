// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "deploy/simulation/courtyard.h"
#include "deploy/simulation/motion.h"
#include "deploy/simulation/noise.h"
#include "deploy/simulation/simulated_scene.h"

namespace coslam::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;
constexpr CourtyardPlan kPlan{18, 8, 0};
constexpr double kRiseS = 0.8, kRateHz = 20, kEndS = 30, kHoldS = 1;
constexpr int kTroop = 6;

double smooth(double x) {
  const double t = std::clamp(x, 0.0, 1.0);
  return t * t * t * (t * (t * 6 - 15) + 10);
}

// From the west side to the east side; the first troop over the south, the second over the north. In the lanes a troop
// parts in halves. All look to the houses in the middle: straight at the start and at the end, ahead on the way.
ViewPath swarm_path(int index) {
  constexpr double kStepM = 1.4, kTurnM = 7;
  const int troop = (index / kTroop) % 2, member = index % kTroop, row = index / (2 * kTroop);
  const bool north = troop == 1;
  const double half_m = kPlan.way_length_m() / 2, lane = member % 2 == 0 ? -1 : 1;
  const int place = member / 2 - 1;
  const double ahead_m = 0.3 + 0.42 * member;
  std::vector<ViewPose> path;
  const int steps = static_cast<int>(std::lround(half_m / kStepM));
  for (int i = 0; i <= steps; ++i) {
    const double gone_m = half_m * i / steps;
    const WayPlace way = way_place(kPlan, gone_m + ahead_m);
    const double inside = in_lanes(kPlan, way, -1), from_end_m = std::min(gone_m, half_m - gone_m);
    const double off_m = (1 - inside) * 0.35 * place + inside * (lane * CourtyardPlan::kLaneM + 0.3 * place);
    const Vector2d at = way.at + off_m * way.outward;
    const double heading_deg = way.heading_deg + 90 - 48 * smooth(from_end_m / kTurnM) + 8 * inside;
    const double up = north ? -1 : 1;  // the north is the south turned over
    path.push_back(
        {{at.x(), up * at.y(), 1.45 + 0.07 * member + 0.14 * row + (north ? 0.04 : 0)}, up * heading_deg, -5, 0});
  }
  std::vector<ViewPose> round = path;
  for (std::size_t i = path.size() - 2; i > 0; --i) round.push_back(path[i]);
  return {round, 0};
}

ViewPose swarm_view(const ViewPath& path, int index, double t_s) {
  const double even = eased_journey(t_s, kEndS, kRiseS) / (kEndS - 2 * kRiseS);
  // The second troop is behind first and catches up.
  const double share = (index / kTroop) % 2 == 0 ? even : even - 0.012 * std::sin(2 * kPi * even);
  const double phase = 1.7 * index;
  const auto off = [&](double period_s, double shift) {
    return std::sin(2 * kPi * t_s / period_s + phase + shift) - std::sin(phase + shift);
  };
  ViewPose out = path.at(0.5 * share * path.length_m());
  const double awake = smooth(t_s / 2);
  out.position_m += awake * Vector3d(0.05 * off(4.7, 0.3), 0.05 * off(5.3, 1.1), 0.06 * off(4.1, 2.0));
  out.heading_deg += awake * 3 * off(6.1, 0.9);
  out.pitch_deg += awake * 1.5 * off(4.5, 1.6);
  out.roll_deg += awake * 1.5 * off(5.1, 2.4);
  return out;
}

}  // namespace

SceneDescription describe_swarm(std::uint64_t seed, int cameras) {
  SceneDescription out;
  out.world = courtyard_world(kPlan, mix(seed, 7));
  out.rate_hz = kRateHz;
  out.frames = static_cast<int>(std::lround((kEndS + kHoldS) * kRateHz));
  out.image_scale = 0.8;
  for (int i = 0; i < cameras; ++i) {
    SceneCamera camera;
    camera.sensor = simulated_sensor(i, seed);
    const ViewPath path = swarm_path(i);
    const HandShake shake(mix(seed, 750 + static_cast<std::uint64_t>(i)), 0.003, 0.25);
    camera.cam_from_world = [i, path, shake](double t_s) {
      return shake.at(t_s) * cam_from_world(swarm_view(path, i, t_s));
    };
    out.cameras.push_back(camera);
  }
  return out;
}

}  // namespace coslam::sim
