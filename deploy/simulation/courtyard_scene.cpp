// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
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
constexpr CourtyardPlan kPlan{20.7, 11.2, 3.2};
constexpr double kRiseS = 0.6, kRateHz = 20, kEndS = 1280 / kRateHz;

// Which lane a camera takes (outer +1) and its place in the lane, of the south and the north side.
struct Lanes {
  double south, south_place, north, north_place;
};
constexpr Lanes kLanes[4] = {{-1, -0.3, 1, -0.3}, {-1, 0.3, -1, -0.3}, {1, -0.3, 1, 0.3}, {1, 0.3, -1, 0.3}};

ViewPath camera_path(int index) {
  constexpr int kWaypoints = 72;
  const Lanes& lanes = kLanes[index % 4];
  const int row = index / 4;
  const double place = (index % 4) - 1.5;
  std::vector<ViewPose> out;
  for (int i = 0; i < kWaypoints; ++i) {
    const double share = static_cast<double>(i) / kWaypoints;
    const WayPlace way = way_place(kPlan, share * kPlan.way_length_m());
    const double south = in_lanes(kPlan, way, -1), north = in_lanes(kPlan, way, 1);
    // Side by side, and on the other side after half the way: each goes inside of the others as long as outside.
    const double off_m = (1 - south - north) * 0.52 * place * std::cos(2 * kPi * share) +
                         south * (lanes.south * CourtyardPlan::kLaneM + lanes.south_place) +
                         north * (lanes.north * CourtyardPlan::kLaneM + lanes.north_place);
    const Vector2d at = way.at + off_m * way.outward;
    out.push_back(
        {{at.x(), at.y(), 1.5 + 0.05 * place + 0.14 * row}, way.heading_deg + 36 + 12 * (south + north), -4, 0});
  }
  return {out, 360};
}

// As a small aircraft flies: along the way, swaying.
ViewPose courtyard_view(const ViewPath& path, int index, double t_s) {
  const double share = eased_journey(t_s, kEndS, kRiseS) / (kEndS - 2 * kRiseS);
  const double phase = 1.7 * index;
  const auto off = [&](double times, double shift) {
    return std::sin(2 * kPi * times * share + phase + shift) - std::sin(phase + shift);
  };
  ViewPose out = path.at(share * path.length_m());
  out.position_m += Vector3d(0.09 * off(13, 0.3), 0.09 * off(11, 1.1), 0.10 * off(15, 2.0));
  out.heading_deg += 5 * off(10, 0.9);
  out.pitch_deg += 2 * off(14, 1.6);
  out.roll_deg += 2 * off(12, 2.4);
  return out;
}

}  // namespace

SceneDescription describe_courtyard(std::uint64_t seed, int cameras) {
  SceneDescription out;
  out.world = courtyard_world(kPlan, mix(seed, 6));
  out.rate_hz = kRateHz;
  out.frames = static_cast<int>(std::lround(kEndS * kRateHz));
  for (int i = 0; i < cameras; ++i) {
    SceneCamera camera;
    camera.sensor = simulated_sensor(i, seed);
    const ViewPath path = camera_path(i);
    const HandShake shake(mix(seed, 700 + static_cast<std::uint64_t>(i)), 0.005, 0.25);
    camera.cam_from_world = [i, path, shake](double t_s) {
      return shake.at(t_s) * cam_from_world(courtyard_view(path, i, t_s));
    };
    out.cameras.push_back(camera);
  }
  return out;
}

}  // namespace coslam::sim
