// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "deploy/simulation/furniture.h"
#include "deploy/simulation/motion.h"
#include "deploy/simulation/person.h"
#include "deploy/simulation/simulated_scene.h"

namespace coslam::sim {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

// kLamp is a bare surface of one tone. The east wall and the ceiling are far away, so that no corner of the room is in
// view of the cameras that come close to the man.
constexpr RoomShell kShell{-3.8,
                           -3.4,
                           9.0,
                           3.2,
                           7.0,
                           MaterialKind::kLamp,
                           MaterialKind::kLamp,
                           MaterialKind::kPlaster,
                           MaterialKind::kBrick,
                           MaterialKind::kLamp};

// From frame 150 to 240 some cameras are close to the man; they come and go in two seconds.
constexpr double kCloseFromS = 150 / 30.0, kCloseToS = 240 / 30.0, kWayS = 2.0;
constexpr double kSeatX = 0.0, kSeatY = 0.4;

void furnish(WorldBuilder& b) {
  // The left part of the wall behind the man.
  add_bookcase(b, {-3.0, 3.2, 0, 0}, 1.2, 2.1, 0.3);
  add_sideboard(b, {-1.9, 3.2, 0, 0}, 0.9, 0.42, 0.8);
  add_book_stack(b, {-1.75, 3.1, 0.8, 5}, 6);
  add_vase(b, {-2.15, 3.1, 0.8, 0}, 0.09, 0.34);
  add_pinboard(b, {-1.95, 3.2, 1.35, 0}, 0.8, 0.9);
  add_print(b, {-0.95, 3.2, 2.1, 0}, 0.5, 0.6, MaterialKind::kPoster);
  add_carton(b, {-1.75, 2.5, 0, 12}, {0.45, 0.4, 0.4});
  add_chair(b, {-2.3, 2.1, 0, 25});
  add_rug(b, {-2.1, 1.9, 0, 0}, 1.8, 1.6);
  // The wall to the left, and what is behind the cameras.
  add_print(b, {-3.8, 1.2, 1.2, 90}, 0.8, 1.0, MaterialKind::kPoster);
  add_sideboard(b, {-3.8, 0.6, 0, 90}, 1.4, 0.42, 0.75);
  add_print(b, {-3.8, 0.1, 1.3, 90}, 0.9, 0.7, MaterialKind::kPicture);
  add_bookcase(b, {-3.8, -1.3, 0, 90}, 1.2, 2.0, 0.3);
  add_sofa(b, {0.6, -3.4, 0, 180}, 2.0);
  add_print(b, {-1.4, -3.4, 1.2, 180}, 0.8, 1.0, MaterialKind::kPoster);
  // He sits on this.
  add_carton(b, {kSeatX, kSeatY + 0.15, 0, 0}, {0.28, 0.3, 0.48});
}

World bare_room(std::uint64_t seed) {
  constexpr double kBareCellM = 0.5, kBareTexelM = 0.05;
  WorldBuilder b(mix(seed, 4));
  add_shell(b, kShell);
  for (Facet& facet : b.world().facets) {
    if (facet.material.kind == MaterialKind::kCeiling) facet.material.kind = MaterialKind::kLamp;
    if (facet.material.kind != MaterialKind::kLamp) continue;
    facet.light_cell_m = kBareCellM;  // in fine cells light has a grain, which is texture
    facet.texel_m = kBareTexelM;
  }
  furnish(b);
  b.begin({});
  b.ceiling_lamp({-1.3, 0.6, 2.95}, 1.3, 0.35, 30);
  b.ceiling_lamp({1.5, -0.4, 2.95}, 1.3, 0.35, 28);
  b.world().ambient = 0.55;
  return b.world();
}

// A man who talks with his hands: feet and hips stay, the rest leans, turns and waves.
Posture sitting(double t_s) {
  constexpr double kHipM = 0.60, kHeadingRad = -0.5 * std::numbers::pi;
  const auto wave = [t_s](double middle_deg, double swing_deg, double period_s, double phase_rad) {
    const double slow = 2 * std::numbers::pi * t_s / period_s + phase_rad;
    return kRadPerDeg * (middle_deg + swing_deg * (0.75 * std::sin(slow) + 0.25 * std::sin(2.3 * slow + 1)));
  };
  const Eigen::Quaterniond facing(Eigen::AngleAxisd(kHeadingRad, Eigen::Vector3d::UnitZ()));
  Posture out;
  out.world_from_pelvis = Rigid3(facing, {kSeatX, kSeatY, kHipM});
  out.torso = {wave(0, 16, 3.8, 4.4), wave(8, 11, 3.6, 4.7), wave(0, 7, 5.0, 4.1)};
  out.head = {wave(0, 28, 3.9, 0.9), wave(-4, 9, 2.9, 0.1), wave(0, 6, 4.7, 1.4)};
  out.arms[0] = {wave(20, 24, 2.7, 0.2), wave(16, 12, 3.3, 1.1), wave(22, 24, 3.1, 0.5), wave(72, 38, 2.3, 1.9)};
  out.arms[1] = {wave(22, 26, 3.1, 2.4), wave(18, 12, 2.6, 0.4), wave(20, 24, 3.7, 2.2), wave(76, 36, 2.5, 0.6)};
  for (int side = 0; side < 2; ++side) {
    const Eigen::Vector3d ankle(side == 0 ? 0.44 : 0.38, side == 0 ? 0.14 : -0.14, kAnkleM - kHipM);
    out.world_from_feet[static_cast<std::size_t>(side)] = Rigid3(facing, out.world_from_pelvis * ankle);
  }
  out.knee_lift = 1.2;
  return out;
}

// How far a camera has come to where it sees little but the man.
double close(double t_s) {
  return eased_step(t_s, kCloseFromS - kWayS, kCloseFromS) - eased_step(t_s, kCloseToS, kCloseToS + kWayS);
}

ViewPose view(int index, double t_s) {
  constexpr int kInRow = 4, kWaypoints = 10;
  constexpr double kPeriodS = 9, kRiseS = 0.5;
  const double place = (index % kInRow) - 1.5;
  const int row = index / kInRow;
  const Eigen::Vector3d row_m(0.06, -0.1, 0.13);
  std::vector<ViewPose> round;
  for (int i = 0; i < kWaypoints; ++i) {
    const double a = 2 * std::numbers::pi * i / kWaypoints, phase = 0.8 * place;
    const auto off = [&](double times, double shift) {
      return std::sin(times * a + phase + shift) - std::sin(phase + shift);
    };
    ViewPose p;
    p.position_m = {0.05 + 0.55 * place + 0.24 * off(1, 0), -1.4 + 0.05 * place * place + 0.16 * off(1, 1.6),
                    1.35 + 0.03 * place + 0.07 * off(2, 0.4)};
    p.position_m += row * row_m;
    p.heading_deg = 96 + 2 * place + 4 * off(1, 2.4);
    p.pitch_deg = -9 + 2 * off(2, 1.1);
    p.roll_deg = 1.2 * off(1, 0.9);
    round.push_back(p);
  }
  const LoopPath path(round, kPeriodS);
  ViewPose out = path.at(eased_start(t_s, kRiseS));
  const int close_place = index % kInRow - kInRow / 2;
  if (close_place < 0) return out;
  constexpr double kCalm = 0.2;  // of the wander, where the man is near
  const ViewPose start = path.at(0);
  const double share = close(t_s);
  const auto come = [&](auto* value, const auto& at_start, const auto& at_man) {
    *value += share * (at_man + kCalm * (*value - at_start) - *value);
  };
  const Eigen::Vector3d at_man(-0.3 + 0.3 * close_place, kSeatY - 1.4, 1.05);
  come(&out.position_m, start.position_m, Eigen::Vector3d(at_man + row * row_m));
  come(&out.heading_deg, start.heading_deg, 66.0 + 2.5 * close_place);
  come(&out.pitch_deg, start.pitch_deg, 14.0);
  return out;
}

}  // namespace

SceneDescription describe_sitting_man(std::uint64_t seed, int cameras) {
  SceneDescription out;
  out.world = bare_room(seed);
  out.frames = 400;
  out.bodies.push_back(make_person(mix(seed, 41), sitting));
  for (int i = 0; i < cameras; ++i) {
    SceneCamera camera;
    camera.sensor = simulated_sensor(i, seed);
    const HandShake shake(mix(seed, 500 + static_cast<std::uint64_t>(i)), 0.003, 0.2);
    camera.cam_from_world = [i, shake](double t_s) { return shake.at(t_s) * cam_from_world(view(i, t_s)); };
    out.cameras.push_back(camera);
  }
  return out;
}

}  // namespace coslam::sim
