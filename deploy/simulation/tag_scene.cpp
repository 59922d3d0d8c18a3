// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/simulation/furniture.h"
#include "deploy/simulation/motion.h"
#include "deploy/simulation/simulated_scene.h"

namespace coslam::sim {
namespace {

constexpr RoomShell kShell{-2.6,
                           -2.6,
                           2.6,
                           2.2,
                           2.7,
                           MaterialKind::kBrick,
                           MaterialKind::kPlaster,
                           MaterialKind::kPlanks,
                           MaterialKind::kPlaster,
                           MaterialKind::kPlanks};
constexpr double kTagM = 0.16;  // the largest that fits a sheet of A4 with its margin

World tag_world(std::uint64_t seed) {
  WorldBuilder b(mix(seed, 10));
  add_shell(b, kShell);
  add_bookcase(b, {-1.7, 2.2, 0, 0}, 1.1, 2.0, 0.3);
  add_sideboard(b, {0.3, 2.2, 0, 0}, 1.7, 0.45, 0.8);
  add_vase(b, {-0.35, 2.08, 0.8, 0}, 0.1, 0.36);
  add_book_stack(b, {0.8, 2.05, 0.8, 8}, 6);
  add_print(b, {-0.6, 2.2, 1.3, 0}, 0.6, 0.85, MaterialKind::kPoster);
  add_tag(b, {0.15, 2.2, 1.35, 0}, kTagM);
  add_print(b, {0.8, 2.2, 1.3, 0}, 0.7, 0.6, MaterialKind::kPicture);
  add_print(b, {1.6, 2.2, 1.1, 0}, 0.6, 0.9, MaterialKind::kPoster);
  add_plant(b, {2.25, 1.9, 0, 0}, 1.4);
  add_carton(b, {1.5, 1.9, 0, 12}, {0.5, 0.4, 0.45});
  furnish_wall(b, {2.6, 0, -90}, -1.5, 2.4);
  furnish_wall(b, {-2.6, 0, 90}, -2.4, 1.6);
  add_rug(b, {0.2, 0.9, 0, 0}, 2.2, 1.4);
  add_chair(b, {-0.9, 1.2, 0, 200});
  b.begin({});
  b.ceiling_lamp({-0.8, 0.6, 2.64}, 1.2, 0.35, 24);
  b.ceiling_lamp({1.2, -0.3, 2.64}, 1.2, 0.35, 24);
  b.world().ambient = 0.6;
  return b.world();
}

LoopPath tag_path(int index) {
  std::vector<ViewPose> path{{{-1.2, -0.7, 1.45}, 74, -7, 0},  {{-0.7, -0.5, 1.52}, 79, -9, 1},
                             {{-0.1, -0.3, 1.46}, 86, -6, -1}, {{0.5, -0.2, 1.42}, 95, -5, 1},
                             {{1.0, 0.0, 1.50}, 104, -8, 0},   {{1.3, 0.3, 1.58}, 113, -11, -2}};
  for (ViewPose& p : path) p.position_m += index * Eigen::Vector3d(0.02, -0.08, 0.03);
  return there_and_back(path, 1.0);
}

}  // namespace

SceneDescription describe_tag(std::uint64_t seed, int cameras) {
  SceneDescription out;
  out.world = tag_world(seed);
  out.frames = 150;
  out.tag_m = kTagM;
  for (int i = 0; i < cameras; ++i) {
    SceneCamera camera;
    camera.sensor = simulated_sensor(i, seed);
    const LoopPath path = tag_path(i);
    const HandShake shake(mix(seed, 1000 + static_cast<std::uint64_t>(i)), 0.003, 0.2);
    camera.cam_from_world = [path, shake](double t_s) { return shake.at(t_s) * cam_from_world(path.at(t_s)); };
    out.cameras.push_back(camera);
  }
  return out;
}

}  // namespace coslam::sim
