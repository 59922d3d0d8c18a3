// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include "deploy/simulation/furniture.h"
#include "deploy/simulation/gait.h"
#include "deploy/simulation/outdoor.h"
#include "deploy/simulation/simulated_scene.h"

namespace coslam::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;
constexpr RoomShell kShell{-9.5,
                           -7.0,
                           9.5,
                           7.0,
                           7.0,
                           MaterialKind::kBrick,
                           MaterialKind::kPlaster,
                           MaterialKind::kPlanks,
                           MaterialKind::kBrick,
                           MaterialKind::kTiles};
constexpr double kGalleryM = 3.4;
// Half axes of the way of the drones, and of what stands in the middle.
constexpr double kLoopX = 6.2, kLoopY = 3.7, kStandX = 1.2, kStandY = 0.8;
constexpr double kRateHz = 20, kEndS = 32, kRiseS = 0.6, kRounds = 1.75;
constexpr double kSpotFromS = 13, kSpotToS = 18, kSpotRampS = 0.7;

// What hangs over the gallery.
void hang_high(WorldBuilder& b, const WallFront& wall, double half_m) {
  for (double along = -half_m + 1.2; along < half_m - 0.8; along += b.random().uniform(1.5, 2.1)) {
    const double z = kGalleryM + b.random().uniform(0.5, 1.0);
    switch (b.random().index(4)) {
      case 0:
        add_print(b, wall.at(along, z), 1.0, 1.4, MaterialKind::kPoster);
        break;
      case 1:
        add_print(b, wall.at(along, z), 1.3, 0.9, MaterialKind::kPicture);
        break;
      case 2:
        add_pinboard(b, wall.at(along, z), 1.1, 1.1);
        break;
      default:
        add_house_window(b, wall.at(along, z), 1.1, 1.5);
    }
  }
}

void add_walls(WorldBuilder& b) {
  constexpr double kDepthM = 0.9, kThickM = 0.25;
  const double x = kShell.x1_m, y = kShell.y1_m;
  for (const auto& [wall, half_m] : {std::pair{WallFront{0, y, 0}, x}, std::pair{WallFront{x, 0, -90}, y},
                                     std::pair{WallFront{0, -y, 180}, x}, std::pair{WallFront{-x, 0, 90}, y}}) {
    furnish_wall(b, wall, -half_m + 0.4, half_m - 0.4);
    add_coarse_block(b, wall.at(0, kGalleryM), {2 * half_m, kDepthM, kThickM}, MaterialKind::kPlanks, 0.45);
    hang_high(b, wall, half_m);
  }
  for (const double side : {-1.0, 1.0}) {
    for (const double end : {-1.0, 1.0}) {
      add_coarse_block(b, {side * (x - 1.2), end * (y - 1.2) + 0.25, 0, 0}, {0.5, 0.5, kShell.height_m},
                       MaterialKind::kBrick, 0.38);
    }
  }
}

// A stand with prints on all sides, and things around it.
void furnish_middle(WorldBuilder& b) {
  add_coarse_block(b, {0, kStandY, 0, 0}, {2 * kStandX, 2 * kStandY, 2.6}, MaterialKind::kPlanks, 0.4);
  for (const double side : {-1.0, 1.0}) {
    const WallFront wide{0, side * kStandY, side > 0 ? 180.0 : 0.0}, narrow{side * kStandX, 0, side * 90};
    add_print(b, wide.at(-0.65, 0.9), 0.8, 1.2, MaterialKind::kPoster);
    add_pinboard(b, wide.at(0.5, 0.9), 1.1, 1.1);
    add_print(b, narrow.at(0, 0.9), 1.0, 1.1, MaterialKind::kPicture);
    add_plant(b, {side * 3.6, side * 0.3, 0, 0}, 1.2);
    add_table(b, {-side * 3.7, side * 0.6, 0, 30 * side}, 1.2, 0.6, 0.74);
    add_book_stack(b, {-side * 3.6, side * 0.5, 0.74, 10}, 6);
    add_rug(b, {side * 6.3, -side * 2.8, 0, 0}, 2.6, 2.0);
  }
}

World atrium_world(std::uint64_t seed) {
  WorldBuilder b(mix(seed, 8));
  add_shell(b, kShell);
  coarsen(b, 0, 0.005, 0.1);
  add_walls(b);
  furnish_middle(b);
  b.begin({});
  for (const double x : {-5.0, 0.0, 5.0}) {
    for (const double y : {-3.0, 3.0}) b.ceiling_lamp({x, y, 6.9}, 1.6, 0.6, 40);
  }
  b.world().ambient = 0.5;
  return b.world();
}

Vector2d on_loop(double angle, double inside_m) {
  return {(kLoopX - inside_m) * std::cos(angle), (kLoopY - inside_m) * std::sin(angle)};
}

ViewPath drone_path(int index) {
  constexpr int kWaypoints = 24;
  const double place = (index % 3) - 1.0;
  const int row = index / 3;
  std::vector<ViewPose> out;
  for (int i = 0; i < kWaypoints; ++i) {
    const double a = 2 * kPi * i / kWaypoints;
    const Vector2d at = on_loop(a, 0.75 * place);
    const double height_m = 2.6 + 0.25 * place + 0.9 * std::sin(2 * a + 0.5 * place) + 0.3 * row;
    out.push_back({{at.x() - 0.1 * row, at.y(), height_m}, a * 180 / kPi + 125, -8, 0});
  }
  return {out, 360};
}

// Flown fast, with turns of the head; from 13 to 18 s the drones stand and turn round once.
ViewPose drone_view(const ViewPath& path, int index, double t_s) {
  const double flown_s = paused_time(eased_start(t_s, kRiseS), kSpotFromS, kSpotToS, kSpotRampS);
  const double share = flown_s / (kEndS - kRiseS - (kSpotToS - kSpotFromS));
  const double phase = 2.1 * (index % 3);
  const auto off = [&](double period_s, double shift) {
    return std::sin(2 * kPi * flown_s / period_s + phase + shift) - std::sin(phase + shift);
  };
  ViewPose out = path.at(kRounds * share * path.length_m());
  out.position_m += Vector3d(0.08 * off(2.9, 0.3), 0.08 * off(3.3, 1.1), 0.1 * off(2.3, 2.0));
  out.heading_deg += 20 * off(3.7, 0.9) + 360 * eased_step(t_s, kSpotFromS + kSpotRampS, kSpotToS - kSpotRampS);
  out.pitch_deg += 4 * off(3.1, 1.6);
  out.roll_deg += 5 * off(2.7, 2.4);
  return out;
}

}  // namespace

SceneDescription describe_atrium(std::uint64_t seed, int cameras) {
  SceneDescription out;
  out.world = atrium_world(seed);
  out.rate_hz = kRateHz;
  out.frames = static_cast<int>(std::lround(kEndS * kRateHz));
  out.lens = "fisheye150";
  const GroundPath around(
      {{2.4, 0}, {2.2, 1.5}, {0, 1.9}, {-2.2, 1.5}, {-2.4, 0}, {-2.2, -1.5}, {0, -1.9}, {2.2, -1.5}});
  const Walk first(Gait{around}, 1.2, 0, {{9, 2}, {21, 1.5}}), second(Gait{around}, 1.1, around.length_m() / 2, {});
  out.bodies.push_back(make_person(mix(seed, 61), [first](double t_s) { return first.at(t_s); }));
  out.bodies.push_back(make_person(mix(seed, 62), [second](double t_s) { return second.at(t_s); }));
  for (int i = 0; i < cameras; ++i) {
    SceneCamera camera;
    camera.sensor = simulated_sensor(i, seed);
    const ViewPath path = drone_path(i);
    const HandShake shake(mix(seed, 800 + static_cast<std::uint64_t>(i)), 0.002, 0.2);
    camera.cam_from_world = [i, path, shake](double t_s) {
      return shake.at(t_s) * cam_from_world(drone_view(path, i, t_s));
    };
    out.cameras.push_back(camera);
  }
  return out;
}

}  // namespace coslam::sim
