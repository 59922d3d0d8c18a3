// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/simulation/furniture.h"
#include "deploy/simulation/motion.h"
#include "deploy/simulation/simulated_scene.h"

namespace coslam::sim {
namespace {

constexpr RoomShell kShell{-3.5,
                           -3.0,
                           3.5,
                           3.0,
                           3.0,
                           MaterialKind::kBrick,
                           MaterialKind::kPlaster,
                           MaterialKind::kPlanks,
                           MaterialKind::kPlaster,
                           MaterialKind::kPlanks};

void furnish_north(WorldBuilder& b) {
  add_bookcase(b, {-1.9, 3.0, 0, 0}, 1.3, 2.1, 0.32);
  add_sideboard(b, {0.5, 3.0, 0, 0}, 1.8, 0.45, 0.82);
  add_vase(b, {-0.1, 2.88, 0.82, 0}, 0.10, 0.38);
  add_book_stack(b, {0.45, 2.85, 0.82, 8}, 6);
  add_carton(b, {1.05, 2.9, 0.82, -14}, {0.36, 0.26, 0.24});
  add_print(b, {-0.55, 3.0, 1.35, 0}, 0.6, 0.85, MaterialKind::kPoster);
  add_print(b, {0.45, 3.0, 1.5, 0}, 0.9, 0.65, MaterialKind::kPicture);
  add_print(b, {1.45, 3.0, 1.25, 0}, 0.7, 1.0, MaterialKind::kPoster);
  add_print(b, {2.35, 3.0, 1.55, 0}, 0.5, 0.6, MaterialKind::kPicture);
  add_print(b, {-2.95, 3.0, 1.3, 0}, 0.55, 0.75, MaterialKind::kPicture);
  add_block(b, {1.95, 3.0, 0, 0}, {0.3, 0.18, 3.0}, MaterialKind::kPlaster, 0.5);
  add_plant(b, {2.95, 2.85, 0, 0}, 1.5);
  add_carton(b, {2.3, 2.7, 0, 10}, {0.5, 0.4, 0.45});
  add_carton(b, {2.32, 2.65, 0.45, -8}, {0.36, 0.3, 0.28});
}

void furnish_east(WorldBuilder& b) {
  add_bookcase(b, {3.5, 1.45, 0, -90}, 1.1, 1.9, 0.3);
  add_carton(b, {3.45, 1.45, 1.9, -95}, {0.5, 0.22, 0.3});
  add_window(b, {3.5, -0.15, 1.0, -90}, 1.3, 1.35, 11.0);
  add_table(b, {3.5, -0.2, 0, -90}, 1.5, 0.7, 0.74);
  add_monitor(b, {3.3, 0.1, 0.74, -80});
  add_book_stack(b, {3.3, -0.65, 0.74, -70}, 5);
  add_chair(b, {2.35, -0.3, 0, 70});
  add_pinboard(b, {3.5, -1.7, 1.05, -90}, 1.2, 1.0);
  add_sideboard(b, {3.5, -1.8, 0, -90}, 1.2, 0.4, 0.75);
  add_print(b, {3.5, 2.45, 1.3, -90}, 0.5, 0.7, MaterialKind::kPoster);
  add_vase(b, {3.35, -2.1, 0.75, -90}, 0.09, 0.3);
}

void furnish_south(WorldBuilder& b) {
  add_sofa(b, {-0.3, -2.95, 0, 180}, 2.1);
  add_print(b, {-0.8, -3.0, 1.25, 180}, 0.8, 1.1, MaterialKind::kPoster);
  add_print(b, {0.35, -3.0, 1.3, 180}, 1.1, 0.8, MaterialKind::kPicture);
  add_floor_lamp(b, {1.3, -2.85, 0, 180});
  add_bookcase(b, {2.3, -3.0, 0, 180}, 1.2, 2.0, 0.3);
  add_carton(b, {-2.1, -2.9, 0, 172}, {0.55, 0.45, 0.5});
  add_carton(b, {-2.1, -2.85, 0.5, 188}, {0.45, 0.4, 0.35});
  add_plant(b, {-3.0, -2.8, 0, 180}, 1.3);
}

void furnish_west(WorldBuilder& b) {
  add_bookcase(b, {-3.5, -1.3, 0, 90}, 1.2, 2.0, 0.32);
  add_pinboard(b, {-3.5, 0.4, 1.0, 90}, 1.4, 1.1);
  add_sideboard(b, {-3.5, 0.4, 0, 90}, 1.5, 0.42, 0.7);
  add_book_stack(b, {-3.3, 0.1, 0.7, 80}, 7);
  add_print(b, {-3.5, 1.65, 1.2, 90}, 0.7, 1.0, MaterialKind::kPoster);
  add_print(b, {-3.5, 2.5, 1.4, 90}, 0.6, 0.5, MaterialKind::kPicture);
  add_carton(b, {-3.4, 2.4, 0, 85}, {0.6, 0.45, 0.6});
}

// Between the walls, low enough for the cameras to look over.
void furnish_middle(WorldBuilder& b) {
  add_rug(b, {0.1, 1.2, 0, 0}, 2.8, 2.4);
  add_table(b, {1.35, 1.75, 0, 12}, 1.1, 0.7, 0.72);
  add_carton(b, {1.6, 1.55, 0.72, -10}, {0.34, 0.26, 0.3});
  add_book_stack(b, {1.15, 1.5, 0.72, 5}, 5);
  add_vase(b, {1.35, 1.35, 0.72, 0}, 0.06, 0.24);
  add_chair(b, {0.45, 1.75, 0, 200});
  add_chair(b, {2.15, 1.0, 0, 60});
  add_carton(b, {-0.75, 2.2, 0, 30}, {0.45, 0.4, 0.42});
  add_plant(b, {2.75, 0.75, 0, 0}, 0.9);
}

World room_world(std::uint64_t seed) {
  WorldBuilder b(mix(seed, 1));
  add_shell(b, kShell);
  furnish_north(b);
  furnish_east(b);
  furnish_south(b);
  furnish_west(b);
  furnish_middle(b);
  b.begin({});
  b.ceiling_lamp({-1.2, 0.4, 2.9}, 1.3, 0.35, 29);
  b.ceiling_lamp({1.5, -0.2, 2.9}, 1.3, 0.35, 29);
  b.world().ambient = 0.6;
  return b.world();
}

// One second apart, passed again and again. All turn to the left first, then to the right, so that they keep seeing
// common things.
std::vector<ViewPose> waypoints(int path) {
  switch (path) {
    case 0:
      return {{{-1.66, -0.72, 1.50}, 50, -9, 0},  {{-1.85, 0.15, 1.55}, 60, -11, 2},
              {{-1.50, 0.95, 1.45}, 78, -8, -2},  {{-0.70, 1.35, 1.40}, 95, -10, -1},
              {{0.20, 1.15, 1.50}, 80, -14, 1},   {{0.90, 0.50, 1.62}, 52, -12, 2},
              {{0.65, -0.40, 1.60}, 24, -9, 0},   {{-0.05, -1.00, 1.52}, 8, -10, -2},
              {{-0.90, -1.40, 1.45}, 14, -8, -1}, {{-1.50, -1.30, 1.45}, 34, -8, 0}};
    case 1:
      return {{{-1.20, -1.10, 1.55}, 50, -10, 0}, {{-0.40, -1.15, 1.60}, 62, -12, -2},
              {{0.50, -0.90, 1.52}, 84, -9, 1},   {{1.25, -0.35, 1.45}, 104, -7, 2},
              {{1.45, 0.50, 1.50}, 98, -10, 0},   {{0.85, 1.10, 1.60}, 72, -13, -2},
              {{0.00, 1.00, 1.65}, 42, -12, -1},  {{-0.85, 0.65, 1.58}, 16, -9, 1},
              {{-1.45, 0.00, 1.50}, 10, -8, 2},   {{-1.60, -0.70, 1.50}, 30, -9, 1}};
    default:
      return {{{-0.70, -1.52, 1.45}, 50, -8, 0},   {{0.05, -1.75, 1.42}, 60, -8, 2},
              {{0.95, -1.65, 1.50}, 80, -11, 1},   {{1.65, -1.15, 1.60}, 104, -12, -1},
              {{1.85, -0.30, 1.62}, 110, -10, -2}, {{1.30, 0.35, 1.52}, 86, -9, 0},
              {{0.45, 0.45, 1.45}, 54, -10, 2},    {{-0.40, 0.10, 1.48}, 26, -12, 1},
              {{-1.00, -0.50, 1.55}, 18, -10, -1}, {{-1.15, -1.15, 1.52}, 32, -8, -1}};
  }
}

SceneCamera room_camera(std::uint64_t seed, int index) {
  constexpr double kPeriodS = 10.0, kRiseS = 0.5;
  std::vector<ViewPose> points = waypoints(index % 3);
  // Further cameras walk beside and above the first three.
  for (ViewPose& p : points) p.position_m += (index / 3) * Eigen::Vector3d(0.08, -0.08, 0.15);
  SceneCamera out;
  out.sensor = simulated_sensor(index, seed);
  const LoopPath path(points, kPeriodS);
  const HandShake shake(mix(seed, 200 + static_cast<std::uint64_t>(index)), 0.003, 0.2);
  out.cam_from_world = [path, shake](double t_s) {
    return shake.at(t_s) * cam_from_world(path.at(eased_start(t_s, kRiseS)));
  };
  return out;
}

}  // namespace

SceneDescription describe_room(std::uint64_t seed, int cameras) {
  SceneDescription out;
  out.world = room_world(seed);
  out.frames = 300;
  for (int i = 0; i < cameras; ++i) out.cameras.push_back(room_camera(seed, i));
  return out;
}

}  // namespace coslam::sim
