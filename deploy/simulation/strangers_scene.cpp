// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <numbers>

#include "deploy/simulation/furniture.h"
#include "deploy/simulation/motion.h"
#include "deploy/simulation/simulated_scene.h"

namespace coslam::sim {
namespace {

using Eigen::Vector3d;

constexpr RoomShell kShell{-7,
                           -4,
                           7,
                           4,
                           3,
                           MaterialKind::kPlaster,
                           MaterialKind::kBrick,
                           MaterialKind::kPlanks,
                           MaterialKind::kPlaster,
                           MaterialKind::kTiles};
constexpr double kPartitionY = 0;  // a partition stands from the south wall to here

World strangers_world(std::uint64_t seed) {
  WorldBuilder b(mix(seed, 8));
  add_shell(b, kShell);
  add_block(b, {0, kPartitionY, 0, 0}, {0.2, kPartitionY - kShell.y0_m, kShell.height_m}, MaterialKind::kBrick, 0.4);
  furnish_wall(b, {0, kShell.y1_m, 0}, -6.6, 6.6);
  furnish_wall(b, {kShell.x1_m, 0, -90}, -3.6, 3.9);
  furnish_wall(b, {kShell.x0_m, 0, 90}, -3.6, 3.9);
  furnish_wall(b, {-3.5, kShell.y0_m, 180}, -3.2, 3.2);
  furnish_wall(b, {3.5, kShell.y0_m, 180}, -3.2, 3.2);
  furnish_wall(b, {-0.1, -2, -90}, -1.8, 1.6);
  furnish_wall(b, {0.1, -2, 90}, -1.6, 1.8);
  add_table(b, {-5.3, 0.4, 0, 75}, 1.3, 0.6, 0.5);
  add_carton(b, {-5.4, 0.3, 0.5, 60}, {0.4, 0.3, 0.3});
  add_chair(b, {5.2, 0.2, 0, -70});
  add_chair(b, {5.0, -1.6, 0, -110});
  add_floor_lamp(b, {-1.6, 3.0, 0, 0});
  add_chair(b, {1.2, 3.1, 0, 15});
  add_rug(b, {0.3, 3.4, 0, 0}, 2.6, 1.3);
  b.begin({});
  for (const double x : {-4.6, 0.0, 4.6}) {
    b.ceiling_lamp({x, 1.9, 2.94}, 1.3, 0.35, 32);
    if (x != 0) b.ceiling_lamp({x, -2.0, 2.94}, 1.3, 0.35, 32);
  }
  b.world().ambient = 0.6;
  return b.world();
}

// The first two look west and the third east at first; then they come round to the north wall, where they meet.
using Waypoints = std::array<ViewPose, 13>;
constexpr double kStepS = 1.25;

Waypoints western_way() {
  return {{{{-3.6, -2.6, 1.50}, 152, -7, 0},
           {{-3.6, -2.2, 1.55}, 148, -8, 1},
           {{-3.4, -1.5, 1.45}, 138, -6, -1},
           {{-3.2, -0.7, 1.52}, 124, -8, -2},
           {{-2.8, 0.1, 1.60}, 108, -9, 0},
           {{-2.2, 0.7, 1.50}, 96, -7, 2},
           {{-1.5, 1, 1.42}, 88, -6, 1},
           {{-0.8, 1, 1.50}, 84, -8, -1},
           {{-0.3, 0.9, 1.58}, 82, -9, -1},
           {{0.1, 1.1, 1.50}, 82, -7, 1},
           {{0.5, 1.3, 1.44}, 84, -6, 2},
           {{0.9, 1.2, 1.50}, 87, -8, 0},
           {{1.2, 1.1, 1.55}, 88, -7, -1}}};
}

Waypoints eastern_way() {
  return {{{{3.4, -2.7, 1.50}, 26, -7, 2},
           {{3.4, -2.3, 1.42}, 30, -6, 1},
           {{3.3, -1.5, 1.50}, 40, -8, -1},
           {{3.1, -0.7, 1.58}, 54, -9, -1},
           {{2.8, 0, 1.50}, 70, -7, 1},
           {{2.5, 0.6, 1.44}, 83, -6, 2},
           {{2.1, 0.9, 1.50}, 91, -8, 0},
           {{1.8, 1, 1.55}, 95, -7, -1},
           {{1.6, 1.2, 1.50}, 96, -7, 0},
           {{1.8, 1.4, 1.55}, 96, -8, 1},
           {{2.1, 1.4, 1.45}, 95, -6, -1},
           {{2.3, 1.2, 1.52}, 94, -8, -2},
           {{2.4, 1.1, 1.60}, 93, -9, 0}}};
}

LoopPath strangers_path(int index) {
  constexpr double kApartM = 0.55;
  const Waypoints way = index % 3 == 2 ? eastern_way() : western_way();
  std::vector<ViewPose> path;
  for (ViewPose p : way) {
    const double heading = p.heading_deg * std::numbers::pi / 180;
    // The second goes to the right of the first.
    if (index % 3 == 1) p.position_m += kApartM * Vector3d(std::sin(heading), -std::cos(heading), 0.1);
    p.position_m += (index / 3) * Vector3d(0.02, -0.04, 0.12);
    path.push_back(p);
  }
  return there_and_back(path, kStepS);
}

}  // namespace

SceneDescription describe_strangers(std::uint64_t seed, int cameras) {
  SceneDescription out;
  out.world = strangers_world(seed);
  out.frames = 300;
  out.rate_hz = 20;
  for (int i = 0; i < cameras; ++i) {
    SceneCamera camera;
    camera.sensor = simulated_sensor(i, seed);
    const LoopPath path = strangers_path(i);
    const HandShake shake(mix(seed, 800 + static_cast<std::uint64_t>(i)), 0.003, 0.2);
    camera.cam_from_world = [path, shake](double t_s) { return shake.at(t_s) * cam_from_world(path.at(t_s)); };
    out.cameras.push_back(camera);
  }
  return out;
}

}  // namespace coslam::sim
