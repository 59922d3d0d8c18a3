// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include "deploy/simulation/furniture.h"
#include "deploy/simulation/motion.h"
#include "deploy/simulation/simulated_scene.h"

namespace coslam::sim {
namespace {

constexpr RoomShell kShell{-4.2,
                           -4.5,
                           3.2,
                           3.0,
                           3.1,
                           MaterialKind::kPlaster,
                           MaterialKind::kBrick,
                           MaterialKind::kPlaster,
                           MaterialKind::kPlanks,
                           MaterialKind::kTiles};

// The turn of the paper's experiment 8.1.1: frames 180 to 256 at 30 Hz.
constexpr double kTurnFromS = 180 / 30.0, kTurnToS = 256 / 30.0;
constexpr double kFirstHeadingDeg = 92, kTurnDeg = -86;

void furnish_first_wall(WorldBuilder& b) {
  add_block(b, {-1.75, 3.0, 0, 0}, {0.4, 0.16, 3.1}, MaterialKind::kBrick, 0.36);
  add_block(b, {1.15, 3.0, 0, 0}, {0.4, 0.16, 3.1}, MaterialKind::kBrick, 0.36);
  add_sideboard(b, {-0.35, 3.0, 0, 0}, 1.7, 0.45, 0.8);
  add_carton(b, {-0.95, 2.9, 0.8, 12}, {0.34, 0.28, 0.3});
  add_vase(b, {-0.45, 2.88, 0.8, 0}, 0.11, 0.42);
  add_book_stack(b, {0.15, 2.85, 0.8, -8}, 7);
  add_print(b, {-1.05, 3.0, 1.45, 0}, 0.65, 0.95, MaterialKind::kPoster);
  add_print(b, {-0.15, 3.0, 1.5, 0}, 0.95, 0.7, MaterialKind::kPicture);
  add_print(b, {0.65, 3.0, 1.35, 0}, 0.45, 0.6, MaterialKind::kPicture);
  add_bookcase(b, {-2.7, 3.0, 0, 0}, 1.2, 2.1, 0.3);
  add_pinboard(b, {-3.75, 3.0, 1.1, 0}, 0.7, 0.9);
  add_bookcase(b, {1.9, 3.0, 0, 0}, 0.9, 1.7, 0.3);
  add_carton(b, {1.9, 2.95, 1.7, 5}, {0.5, 0.24, 0.28});
  add_chair(b, {0.9, 2.0, 0, 160});
  add_carton(b, {-1.5, 2.35, 0, 20}, {0.5, 0.4, 0.45});
}

void furnish_corner(WorldBuilder& b) {
  add_plant(b, {2.6, 2.8, 0, 0}, 1.7);
  add_print(b, {2.75, 3.0, 1.75, 0}, 0.6, 0.8, MaterialKind::kPoster);
  add_print(b, {3.2, 2.35, 1.5, -90}, 0.7, 1.0, MaterialKind::kPoster);
  add_carton(b, {2.95, 2.1, 0, -80}, {0.55, 0.45, 0.5});
  add_carton(b, {2.95, 2.1, 0.5, -100}, {0.4, 0.35, 0.32});
}

void furnish_second_wall(WorldBuilder& b) {
  add_bookcase(b, {3.2, 1.2, 0, -90}, 1.1, 2.0, 0.3);
  add_table(b, {3.2, -0.35, 0, -90}, 1.5, 0.65, 0.74);
  add_monitor(b, {3.05, -0.1, 0.74, -85});
  add_book_stack(b, {3.05, -0.75, 0.74, -75}, 6);
  add_print(b, {3.2, 0.3, 1.45, -90}, 0.55, 0.8, MaterialKind::kPoster);
  add_print(b, {3.2, -0.5, 1.4, -90}, 0.85, 0.65, MaterialKind::kPicture);
  add_block(b, {3.2, -1.35, 0, -90}, {0.35, 0.16, 3.1}, MaterialKind::kPlaster, 0.6);
  add_pinboard(b, {3.2, -2.1, 1.05, -90}, 0.9, 1.0);
  add_sideboard(b, {3.2, -2.15, 0, -90}, 1.2, 0.42, 0.72);
  add_vase(b, {3.05, -2.4, 0.72, -90}, 0.1, 0.32);
  add_plant(b, {2.9, -3.1, 0, -90}, 1.4);
  add_chair(b, {2.15, -0.5, 0, 60});
  add_print(b, {3.2, -3.3, 1.4, -90}, 0.7, 0.9, MaterialKind::kPoster);
}

void furnish_rest(WorldBuilder& b) {
  add_rug(b, {0.4, 1.9, 0, 0}, 2.6, 1.9);
  add_sofa(b, {-1.0, -4.4, 0, 180}, 2.0);
  add_print(b, {-1.0, -4.5, 1.3, 180}, 1.0, 0.8, MaterialKind::kPicture);
  add_bookcase(b, {1.2, -4.5, 0, 180}, 1.2, 1.9, 0.3);
  add_print(b, {-4.2, -0.5, 1.3, 90}, 0.8, 1.0, MaterialKind::kPoster);
  add_bookcase(b, {-4.2, 1.0, 0, 90}, 1.2, 2.0, 0.3);
}

World wall_world(std::uint64_t seed) {
  WorldBuilder b(mix(seed, 2));
  add_shell(b, kShell);
  furnish_first_wall(b);
  furnish_corner(b);
  furnish_second_wall(b);
  furnish_rest(b);
  b.begin({});
  b.ceiling_lamp({-1.0, 0.9, 3.0}, 1.3, 0.35, 34);
  b.ceiling_lamp({1.2, -0.6, 3.0}, 0.35, 1.3, 34);
  b.ceiling_lamp({-1.6, -2.6, 3.0}, 1.0, 0.35, 27);
  b.world().ambient = 0.6;
  return b.world();
}

// sin(2 pi t / period + phase), less its value at t = 0: the cameras start in formation.
double sway(double t_s, double period_s, double phase_rad) {
  return std::sin(2 * std::numbers::pi * t_s / period_s + phase_rad) - std::sin(phase_rad);
}

// The cameras stand on a line across the bisector of the two walls, so that they see each from different places.
ViewPose wall_view(int index, double t_s) {
  constexpr double kPauseRampS = 0.5, kRiseS = 0.5;
  const double walked_s = eased_start(paused_time(t_s, kTurnFromS, kTurnToS, kPauseRampS), kRiseS);
  const double phase = 0.9 * (index % 3), row = static_cast<double>(index / 3);
  const double place = (index % 3) - 1.0 + 0.33 * row;
  ViewPose out;
  out.position_m = {-0.25 + 0.56 * place, -0.40 - 0.52 * place, 1.5 + 0.09 * ((index % 3) - 1) + 0.15 * row};
  out.position_m.x() += 0.42 * sway(walked_s, 5.2, phase);
  out.position_m.y() += 0.26 * sway(walked_s, 4.3, phase + 0.8);
  out.position_m.z() += 0.13 * sway(walked_s, 3.7, phase + 1.9);
  out.heading_deg =
      kFirstHeadingDeg + kTurnDeg * eased_step(t_s, kTurnFromS, kTurnToS) + 5 * sway(walked_s, 5.9, phase + 2.6);
  out.pitch_deg = -8 + 3 * sway(walked_s, 4.7, phase);
  out.roll_deg = 1.5 * sway(walked_s, 5.5, phase + 1.0);
  return out;
}

}  // namespace

SceneDescription describe_wall(std::uint64_t seed, int cameras) {
  SceneDescription out;
  out.world = wall_world(seed);
  out.frames = 330;
  for (int i = 0; i < cameras; ++i) {
    SceneCamera camera;
    camera.sensor = simulated_sensor(i, seed);
    const HandShake shake(mix(seed, 300 + static_cast<std::uint64_t>(i)), 0.003, 0.2);
    camera.cam_from_world = [i, shake](double t_s) { return shake.at(t_s) * cam_from_world(wall_view(i, t_s)); };
    out.cameras.push_back(camera);
  }
  return out;
}

}  // namespace coslam::sim
