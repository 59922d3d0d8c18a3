// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "deploy/simulation/gait.h"
#include "deploy/simulation/outdoor.h"
#include "deploy/simulation/simulated_scene.h"

namespace coslam::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kHalfX = 14.5, kHalfY = 11.5;  // of the garden
constexpr double kLoopX = 11.5, kLoopY = 8.0;   // half axes of the way of the cameras, before it gets its length
constexpr double kLoopM = 63, kLoopS = 1500 / 30.0, kRiseS = 0.5;

void add_ground(WorldBuilder& b) {
  std::size_t first = b.world().facets.size();
  b.begin({});
  b.rect({-kHalfX, kHalfY, 0}, {2 * kHalfX, 0, 0}, {0, -2 * kHalfY, 0}, b.material(MaterialKind::kTiles, 0.42));
  b.begin({});
  b.rect({-6.9, 3.9, 0.01}, {13.8, 0, 0}, {0, -7.8, 0}, b.material(MaterialKind::kFoliage, 0.42));
  coarsen(b, first, kGroundTexelM, 0.1);
}

void add_bounds(WorldBuilder& b) {
  add_coarse_block(b, {0, kHalfY + 0.4, 0, 0}, {2 * kHalfX, 0.4, 5.5}, MaterialKind::kBrick, 0.36);
  add_coarse_block(b, {kHalfX + 0.3, 0, 0, -90}, {2 * kHalfY, 0.3, 2.3}, MaterialKind::kBrick, 0.42);
  add_coarse_block(b, {0, -kHalfY - 0.6, 0, 180}, {2 * kHalfX, 0.6, 2.1}, MaterialKind::kFoliage, 0.5);
  add_coarse_block(b, {-kHalfX - 0.4, 0, 0, 90}, {2 * kHalfY, 0.4, 4.5}, MaterialKind::kPlanks, 0.42);
  for (int i = 0; i < 8; ++i) {
    const double x = -12.6 + 3.6 * i;
    add_house_window(b, {x, kHalfY, 0.9, 0}, 1.1, 1.4);
    add_house_window(b, {x, kHalfY, 3.3, 0}, 1.1, 1.4);
  }
  for (int i = 0; i < 5; ++i) {
    const double y = -9 + 4.5 * i;
    add_house_window(b, {-kHalfX, y, 1.0, 90}, 1.2, 1.4);
    add_pinboard(b, {kHalfX, y, 1.0, -90}, 1.2, 1.0);
    add_print(b, {kHalfX, y + 2, 1.0, -90}, 0.9, 1.1, i % 2 == 0 ? MaterialKind::kPoster : MaterialKind::kPicture);
  }
  for (int i = 0; i < 7; ++i) {
    add_print(b, {-10.8 + 3.6 * i, kHalfY, 1.0, 0}, 0.9, 1.2,
              i % 2 == 0 ? MaterialKind::kPoster : MaterialKind::kPicture);
  }
}

// Outside the way: between it and the bounds.
void furnish_rim(WorldBuilder& b) {
  for (const double side : {-1.0, 1.0}) {
    for (int i = 0; i < 4; ++i) {
      const double x = -10 + 6.7 * i;
      add_plant(b, {x, side * (kHalfY - 0.7), 0, 0}, 1.4);
      if (i % 2 == 0) add_table(b, {x + 2, side * (kHalfY - 0.2), 0, side > 0 ? 0.0 : 180.0}, 1.5, 0.45, 0.45);
    }
    for (int i = 0; i < 3; ++i) {
      add_plant(b, {side * (kHalfX - 0.7), -6 + 5.5 * i, 0, 0}, 1.3);
      add_carton(b, {side * (kHalfX - 0.5), -3.4 + 5.0 * i, 0, 20.0 * i}, {0.6, 0.5, 0.55});
    }
    for (const double end : {-1.0, 1.0}) {
      add_tree(b, side * (kHalfX - 1.3), end * (kHalfY - 1.5), 0.22);
      add_coarse_block(b, {side * (kHalfX - 3.5), end * (kHalfY - 0.6), 0, 0}, {2.6, 0.7, 1.1}, MaterialKind::kFoliage,
                       0.45);
    }
  }
}

// On the lawn that the cameras go around: things to look at, in a ring, and a shed in the middle.
void furnish_lawn(WorldBuilder& b) {
  add_coarse_block(b, {0, 0.8, 0, 0}, {2.6, 1.6, 2.3}, MaterialKind::kPlanks, 0.4);
  add_house_window(b, {-0.5, -0.8, 0.9, 0}, 0.7, 0.8);
  add_print(b, {0.7, -0.8, 0.8, 0}, 0.6, 0.9, MaterialKind::kPoster);
  add_print(b, {0.3, 0.8, 0.8, 180}, 0.9, 0.9, MaterialKind::kPicture);
  add_pinboard(b, {-1.3, 0, 0.9, -90}, 1.0, 0.9);
  add_pinboard(b, {1.3, 0, 0.9, 90}, 1.0, 0.9);
  constexpr int kThings = 14;
  for (int i = 0; i < kThings; ++i) {
    const double angle = 2 * std::numbers::pi * i / kThings;
    const double x = 6.3 * std::cos(angle), y = 3.45 * std::sin(angle), turn_deg = angle * 180 / std::numbers::pi + 90;
    switch (i % 7) {
      case 0:
      case 3:
        add_tree(b, x, y, b.random().uniform(0.14, 0.2));
        break;
      case 1:
        add_coarse_block(b, {x, y, 0, turn_deg}, {1.5, 0.4, 0.9}, MaterialKind::kFoliage, 0.5);
        break;
      case 2:
        add_plant(b, {x, y, 0, turn_deg}, 1.3);
        break;
      case 4:
        add_table(b, {x, y, 0, turn_deg}, 1.4, 0.4, 0.45);
        add_vase(b, {x, y, 0.45, turn_deg}, 0.1, 0.35);
        break;
      case 5:
        add_carton(b, {x, y, 0, turn_deg}, {0.5, 0.4, 0.5});
        add_carton(b, {x, y, 0.5, turn_deg + 20}, {0.4, 0.3, 0.35});
        break;
      default:
        add_vase(b, {x, y, 0, turn_deg}, 0.28, 1.1);
    }
  }
}

World garden_world(std::uint64_t seed) {
  WorldBuilder b(mix(seed, 5));
  add_ground(b);
  add_horizon(b, 32, 28);
  add_bounds(b);
  furnish_rim(b);
  furnish_lawn(b);
  add_sun(b, {7, -9, 21}, 0.75);
  b.world().ambient = 0.38;
  return b.world();
}

// Counter-clockwise, a part of the way inside the way of the cameras.
std::vector<Vector2d> oval(double inside_m, double scale) {
  constexpr int kWaypoints = 16;
  std::vector<Vector2d> out;
  for (int i = 0; i < kWaypoints; ++i) {
    const double a = 2 * std::numbers::pi * i / kWaypoints - 0.5 * std::numbers::pi;
    out.emplace_back((scale * kLoopX - inside_m) * std::cos(a), (scale * kLoopY - inside_m) * std::sin(a));
  }
  return out;
}

double loop_scale() { return kLoopM / GroundPath(oval(0, 1)).length_m(); }

double walked_m(double t_s) { return kLoopM * eased_start(t_s, kRiseS) / (kLoopS - kRiseS); }

// Along the way, looking ahead and to the lawn.
ViewPose garden_view(const GroundPath& way, int index, double t_s) {
  const double place = (index % 3) - 1.0;
  const int row = index / 3;
  const double gone_m = walked_m(t_s), turn = 2 * std::numbers::pi * gone_m / kLoopM;
  const auto off = [&](double times, double shift) {
    const double phase = 0.9 * place + shift;
    return std::sin(times * turn + phase) - std::sin(phase);
  };
  const Vector2d at = way.at(gone_m);
  ViewPose out;
  // The same way for all, side by side at the start: they are in each other's tracks in the long parts and abreast in
  // the short ones.
  out.position_m = {at.x() + 0.3 * place + 0.12 * off(5, 0.2), at.y() + 0.48 * place + 0.12 * off(4, 1.3),
                    1.55 + 0.04 * place + 0.05 * off(9, 0.5)};
  out.position_m += row * Vector3d(0.03, -0.03, 0.12);
  out.heading_deg = way.heading_rad(gone_m) * 180 / std::numbers::pi + 38 - 3 * place + 7 * off(6, 2.1);
  out.pitch_deg = -6 + 2 * off(7, 1.0);
  out.roll_deg = 1.2 * off(8, 0.3);
  return out;
}

// Somebody who goes with the cameras on the lawn's side of them, now nearer and now farther ahead.
Body companion(std::uint64_t seed, double scale, double inside_m, double ahead_m, double swing_m, double period_s) {
  const Gait gait{GroundPath(oval(inside_m, scale))};
  const double share = gait.path().length_m() / kLoopM;
  return make_person(seed, [=](double t_s) {
    return gait.at(share * walked_m(std::max(t_s, 0.0)) + ahead_m +
                   swing_m * std::sin(2 * std::numbers::pi * t_s / period_s));
  });
}

}  // namespace

SceneDescription describe_garden(std::uint64_t seed, int cameras) {
  SceneDescription out;
  out.world = garden_world(seed);
  out.frames = 1500;
  const double scale = loop_scale();
  const GroundPath way(oval(0, scale));
  out.bodies.push_back(companion(mix(seed, 51), scale, 1.05, 1.5, 0.5, 11));
  out.bodies.push_back(companion(mix(seed, 52), scale, 2.4, 2.7, 1.0, 17));
  // One comes towards them, one goes around the shed and rests at times.
  std::vector<Vector2d> back = oval(1.7, scale);
  std::reverse(back.begin(), back.end());
  const Walk towards(Gait{GroundPath(back)}, 1.15, 12, {});
  out.bodies.push_back(make_person(mix(seed, 53), [towards](double t_s) { return towards.at(t_s); }));
  const Walk around(
      Gait{GroundPath(
          {{3.9, 0}, {2.6, 1.75}, {0, 2.1}, {-2.6, 1.75}, {-3.9, 0}, {-2.6, -1.75}, {0, -2.1}, {2.6, -1.75}})},
      1.1, 0, {{8, 2}, {20, 3}, {31, 2}});
  out.bodies.push_back(make_person(mix(seed, 54), [around](double t_s) { return around.at(t_s); }));
  for (int i = 0; i < cameras; ++i) {
    SceneCamera camera;
    camera.sensor = simulated_sensor(i, seed);
    const HandShake shake(mix(seed, 600 + static_cast<std::uint64_t>(i)), 0.006, 0.3);
    camera.cam_from_world = [i, way, shake](double t_s) {
      return shake.at(t_s) * cam_from_world(garden_view(way, i, t_s));
    };
    out.cameras.push_back(camera);
  }
  return out;
}

}  // namespace coslam::sim
