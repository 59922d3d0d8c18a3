// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include "deploy/simulation/cart.h"
#include "deploy/simulation/furniture.h"
#include "deploy/simulation/gait.h"
#include "deploy/simulation/simulated_scene.h"

namespace coslam::sim {
namespace {

constexpr RoomShell kShell{-4.2,
                           -3.8,
                           4.2,
                           4.0,
                           3.0,
                           MaterialKind::kPlaster,
                           MaterialKind::kBrick,
                           MaterialKind::kPlaster,
                           MaterialKind::kPlanks,
                           MaterialKind::kPlanks};

void furnish_north(WorldBuilder& b) {
  add_bookcase(b, {-3.2, 4.0, 0, 0}, 1.3, 2.0, 0.32);
  add_pinboard(b, {-1.75, 4.0, 1.2, 0}, 1.1, 1.1);
  add_sideboard(b, {-1.6, 4.0, 0, 0}, 1.5, 0.42, 0.8);
  add_book_stack(b, {-1.2, 3.9, 0.8, 5}, 6);
  add_vase(b, {-2.05, 3.9, 0.8, 0}, 0.09, 0.34);
  add_print(b, {-0.4, 4.0, 1.3, 0}, 0.7, 1.0, MaterialKind::kPoster);
  add_print(b, {0.6, 4.0, 1.5, 0}, 1.0, 0.75, MaterialKind::kPicture);
  add_bookcase(b, {0.3, 4.0, 0, 0}, 1.3, 1.2, 0.3);
  add_block(b, {1.45, 4.0, 0, 0}, {0.35, 0.16, 3.0}, MaterialKind::kBrick, 0.35);
  add_print(b, {2.2, 4.0, 1.2, 0}, 0.75, 1.1, MaterialKind::kPoster);
  add_carton(b, {2.2, 3.9, 0, 8}, {0.5, 0.4, 0.5});
  add_bookcase(b, {3.4, 4.0, 0, 0}, 1.2, 2.1, 0.3);
}

void furnish_sides(WorldBuilder& b) {
  add_bookcase(b, {-4.2, 1.6, 0, 90}, 1.3, 2.0, 0.3);
  add_print(b, {-4.2, 0.3, 1.3, 90}, 0.9, 0.7, MaterialKind::kPicture);
  add_sideboard(b, {-4.2, 0.1, 0, 90}, 1.3, 0.4, 0.75);
  add_print(b, {-4.2, 2.9, 1.2, 90}, 0.7, 1.0, MaterialKind::kPoster);
  add_carton(b, {-4.1, 2.9, 0, 80}, {0.5, 0.4, 0.45});
  add_print(b, {-4.2, -1.1, 1.2, 90}, 0.7, 1.0, MaterialKind::kPoster);
  add_window(b, {4.2, 1.2, 1.0, -90}, 1.3, 1.3, 5.0);
  add_table(b, {4.2, 1.2, 0, -90}, 1.4, 0.6, 0.74);
  add_monitor(b, {4.0, 1.4, 0.74, -85});
  add_book_stack(b, {4.0, 0.7, 0.74, -75}, 6);
  add_print(b, {4.2, 2.7, 1.2, -90}, 0.7, 1.0, MaterialKind::kPoster);
  add_carton(b, {4.1, 2.8, 0, -95}, {0.6, 0.4, 0.5});
  add_bookcase(b, {4.2, -0.5, 0, -90}, 1.2, 1.9, 0.3);
  add_sofa(b, {0.3, -3.8, 0, 180}, 2.0);
  add_print(b, {-1.6, -3.8, 1.2, 180}, 0.8, 1.0, MaterialKind::kPoster);
}

// The man walks round this.
void furnish_middle(WorldBuilder& b) {
  add_rug(b, {0, 1.9, 0, 0}, 2.6, 2.0);
  add_table(b, {0.1, 1.35, 0, 6}, 1.0, 0.6, 0.55);
  add_carton(b, {-0.15, 1.2, 0.55, 12}, {0.36, 0.28, 0.24});
  add_book_stack(b, {0.38, 1.2, 0.55, -8}, 5);
}

World dim_room(std::uint64_t seed) {
  WorldBuilder b(mix(seed, 3));
  add_shell(b, kShell);
  furnish_north(b);
  furnish_sides(b);
  furnish_middle(b);
  b.begin({});
  b.ceiling_lamp({-1.4, 1.6, 2.9}, 1.0, 0.3, 14);
  b.ceiling_lamp({1.6, 0.2, 2.9}, 1.0, 0.3, 12);
  b.world().ambient = 0.30;
  return b.world();
}

// Somebody who holds a camera and shifts from foot to foot.
ViewPose held_view(int index, double t_s) {
  const double place = (index % 3) - 1.0;
  const int row = index / 3;
  std::vector<ViewPose> round;
  constexpr int kWaypoints = 10;
  for (int i = 0; i < kWaypoints; ++i) {
    const double a = 2 * std::numbers::pi * i / kWaypoints, phase = 0.7 * place;
    const auto off = [&](double times, double shift) {
      return std::sin(times * a + phase + shift) - std::sin(phase + shift);
    };  // from the formation
    ViewPose view;
    view.position_m = {0.6 * place + 0.38 * off(1, 0), -2.45 - 0.1 * place * place + 0.3 * off(1, 1.7),
                       1.5 + 0.04 * place + 0.09 * off(2, 0.4)};
    view.heading_deg = 90 - 4 * place + 7 * off(1, 2.6);
    view.pitch_deg = -8 + 2 * off(2, 1.1);
    view.roll_deg = 1.5 * off(1, 0.9);
    // Further cameras stand behind and above the first three.
    view.position_m += row * Eigen::Vector3d(0.1, -0.06, 0.13);
    round.push_back(view);
  }
  constexpr double kPeriodS = 10, kRiseS = 0.5;
  return LoopPath(round, kPeriodS).at(eased_start(t_s, kRiseS));
}

SceneCamera held_camera(std::uint64_t seed, int index) {
  SceneCamera out;
  out.sensor = simulated_sensor(index, seed);
  // Little light: the sensor counts few electrons, and amplifies them.
  out.sensor.full_well_e = 5000;
  out.sensor.read_noise_e = 22;
  out.sensor.gain *= 0.85;
  const HandShake shake(mix(seed, 400 + static_cast<std::uint64_t>(index)), 0.004, 0.25);
  out.cam_from_world = [index, shake](double t_s) { return shake.at(t_s) * cam_from_world(held_view(index, t_s)); };
  return out;
}

SceneDescription man_in_dim_room(std::uint64_t seed, int cameras, const GroundPath& path,
                                 const std::vector<Rest>& rests) {
  constexpr double kSpeed_m_s = 1.2, kStartM = 0.3;
  SceneDescription out;
  out.world = dim_room(seed);
  const Walk walk(Gait(path), kSpeed_m_s, kStartM, rests);
  out.bodies.push_back(make_person(mix(seed, 31), [walk](double t_s) { return walk.at(t_s); }));
  for (int i = 0; i < cameras; ++i) out.cameras.push_back(held_camera(seed, i));
  return out;
}

}  // namespace

SceneDescription describe_walking_man(std::uint64_t seed, int cameras) {
  const GroundPath path(
      {{-1.9, 0.9}, {-1.2, 0.0}, {0.0, -0.25}, {1.2, 0.0}, {1.9, 0.9}, {1.3, 2.0}, {0.0, 2.4}, {-1.3, 2.0}});
  SceneDescription out = man_in_dim_room(seed, cameras, path, {{3.5, 1.4}, {9.0, 1.8}, {15.5, 1.2}});
  out.frames = 600;
  constexpr double kCartFromS = 7, kCartToS = 12.5, kCartWayM = 5.2;
  out.bodies.push_back(make_cart(mix(seed, 32), {-2.6, 3.05}, 0,
                                 [=](double t_s) { return kCartWayM * eased_step(t_s, kCartFromS, kCartToS); }));
  return out;
}

// He comes round to the first camera, stands before it and hides more than half of the room from it.
SceneDescription describe_stopping_man(std::uint64_t seed, int cameras) {
  const GroundPath path({{-1.9, 0.9},
                         {-1.3, 2.0},
                         {0.0, 2.4},
                         {1.3, 2.0},
                         {1.9, 0.9},
                         {1.2, -0.2},
                         {0.1, -0.9},
                         {-0.45, -2.1},
                         {-1.3, -0.9}});
  SceneDescription out = man_in_dim_room(seed, cameras, path, {{3.5, 1.4}, {9.1, 2.0}});
  out.frames = 450;
  return out;
}

}  // namespace coslam::sim
