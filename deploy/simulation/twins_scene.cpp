// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "deploy/simulation/furniture.h"
#include "deploy/simulation/motion.h"
#include "deploy/simulation/simulated_scene.h"

namespace coslam::sim {
namespace {

using Eigen::Vector3d;

constexpr double kHalfX = 3.6, kHalfY = 3.0;
constexpr double kRoomX[2] = {0, 20};  // middles of the two rooms
constexpr std::uint64_t kShells = 100, kOwnThings = 200;

// The things that both rooms have. A piece is the same in each: its details are drawn from a generator of its own.
class Stock {
 public:
  Stock(WorldBuilder& b, std::uint64_t seed) : b_(b), seed_(seed) {}

  void print(std::uint64_t number, const Placement& at, double width_m, double height_m, MaterialKind kind) {
    draw_from(number);
    add_print(b_, at, width_m, height_m, kind);
  }
  void sideboard(const Placement& at) {
    draw_from(20);
    add_sideboard(b_, at, 1.5, 0.42, 0.78);
  }
  void desk(const WallFront& wall, double along_m) {
    draw_from(21);
    add_table(b_, wall.at(along_m, 0), 1.4, 0.6, 0.74);
    add_monitor(b_, wall.at(along_m + 0.2, 0.74, 0.1));
  }
  void vase(const Placement& at) {
    draw_from(22);
    add_vase(b_, at, 0.11, 0.38);
  }
  void chair(const Placement& at) {
    draw_from(23);
    add_chair(b_, at);
  }
  void rug(const Placement& at) {
    draw_from(24);
    add_rug(b_, at, 2.4, 1.6);
  }
  // From here on what is drawn is found nowhere else.
  void draw_from(std::uint64_t number) { b_.random() = Random(mix(seed_, number)); }

 private:
  WorldBuilder& b_;
  std::uint64_t seed_;
};

struct Hung {
  std::uint64_t number;
  int wall;  // 0 north, 1 east, 2 west
  double along_m, z_m;
};

// The same posters and pictures at other places: another order, other distances, other heights.
constexpr std::array<std::array<Hung, 8>, 2> kHung{{{{{1, 0, -2.7, 1.25},
                                                      {2, 0, -1.5, 1.45},
                                                      {3, 0, 0.1, 1.30},
                                                      {4, 0, 1.9, 1.40},
                                                      {5, 2, 1.2, 1.30},
                                                      {6, 2, -0.6, 1.45},
                                                      {7, 1, -1.6, 1.30},
                                                      {8, 1, 0.3, 1.50}}},
                                                    {{{1, 0, 0.7, 1.40},
                                                      {2, 1, -1.0, 1.30},
                                                      {3, 0, -2.3, 1.50},
                                                      {4, 2, 1.5, 1.25},
                                                      {5, 0, 2.4, 1.30},
                                                      {6, 0, -0.7, 1.25},
                                                      {7, 2, -0.1, 1.50},
                                                      {8, 1, -2.3, 1.40}}}}};

void hang(Stock& stock, const Hung& h, const std::array<WallFront, 4>& walls) {
  const double width = 0.5 + 0.06 * static_cast<double>(h.number % 4), height = h.number % 2 == 0 ? 0.45 : 0.8;
  stock.print(h.number, walls[static_cast<std::size_t>(h.wall)].at(h.along_m, h.z_m), width, height,
              h.number % 2 == 0 ? MaterialKind::kPicture : MaterialKind::kPoster);
}

void add_room(WorldBuilder& b, std::uint64_t seed, std::size_t room) {
  const double x = kRoomX[room];
  const std::array<WallFront, 4> walls{{{x, kHalfY, 0}, {x + kHalfX, 0, -90}, {x - kHalfX, 0, 90}, {x, -kHalfY, 180}}};
  Stock stock(b, seed);
  stock.draw_from(kShells + room);
  add_shell(b, {x - kHalfX, -kHalfY, x + kHalfX, kHalfY, 3, MaterialKind::kPlaster, MaterialKind::kPlaster,
                MaterialKind::kPlanks, MaterialKind::kPlaster, MaterialKind::kTiles});
  for (const Hung& h : kHung[room]) hang(stock, h, walls);
  const bool first = room == 0;
  stock.sideboard(walls[0].at(first ? -0.6 : 1.3, 0));
  stock.vase(walls[0].at(first ? -0.1 : 0.9, 0.78, 0.1));
  stock.desk(walls[1], first ? 0.6 : -0.6);
  stock.chair({x + (first ? 2.2 : 2.4), first ? -0.5 : 0.9, 0, first ? 75.0 : 100.0});
  stock.rug({x + (first ? -0.2 : 0.3), 2.0, 0, 0});
  stock.draw_from(kOwnThings + room);
  add_bookcase(b, walls[first ? 2 : 1].at(first ? -2.2 : 1.8, 0), 1.1, 2.0, 0.3);
  add_plant(b, walls[0].at(first ? 3.0 : -3.0, 0, 0.2), 1.5);
  add_carton(b, walls[2].at(first ? 0.4 : -1.2, 0), {0.5, 0.4, 0.45});
  add_carton(b, walls[0].at(first ? 1.3 : -1.6, 0, 0.1), {0.45, 0.35, 0.5});
  furnish_wall(b, walls[3], -3.2, 3.2);
  b.begin({});
  b.ceiling_lamp({x - 1.4, 0.8, 2.94}, 1.2, 0.35, 30);
  b.ceiling_lamp({x + 1.5, 0.6, 2.94}, 1.2, 0.35, 30);
  b.ceiling_lamp({x, -1.8, 2.94}, 1.2, 0.35, 26);
}

World twins_world(std::uint64_t seed) {
  WorldBuilder b(mix(seed, 9));
  for (const std::size_t room : {0U, 1U}) add_room(b, mix(seed, 10), room);
  b.world().ambient = 0.6;
  return b.world();
}

// From one side of the room to the other and back, looking at three of the walls; each room in its own way.
LoopPath twins_path(int index) {
  const bool first = index % 2 == 0;
  std::vector<ViewPose> way;
  if (first) {
    way = {{{-1.7, -0.9, 1.50}, 128, -8, 0}, {{-1.4, -0.7, 1.55}, 124, -8, 1}, {{-0.8, -0.3, 1.45}, 108, -7, -1},
           {{0.1, -0.2, 1.52}, 90, -9, -1},  {{0.9, -0.5, 1.60}, 72, -8, 1},   {{1.4, -0.9, 1.50}, 54, -7, 2},
           {{1.5, -1.2, 1.44}, 44, -8, 0}};
  } else {
    way = {{{1.6, -0.6, 1.48}, 60, -7, 0},   {{1.3, -0.5, 1.44}, 64, -8, -1},  {{0.6, -0.1, 1.52}, 80, -9, 1},
           {{-0.3, -0.3, 1.60}, 96, -8, 2},  {{-1.0, -0.7, 1.55}, 114, -7, 0}, {{-1.5, -0.9, 1.46}, 128, -7, -2},
           {{-1.7, -1.2, 1.50}, 136, -8, -1}};
  }
  for (ViewPose& p : way)
    p.position_m += Vector3d(kRoomX[first ? 0 : 1], 0, 0) + (index / 2) * Vector3d(0.02, -0.03, 0.1);
  return there_and_back(way, 1.25);
}

}  // namespace

SceneDescription describe_twins(std::uint64_t seed, int cameras) {
  SceneDescription out;
  out.world = twins_world(seed);
  out.frames = 300;
  out.rate_hz = 20;
  for (int i = 0; i < cameras; ++i) {
    SceneCamera camera;
    camera.sensor = simulated_sensor(i, seed);
    const LoopPath path = twins_path(i);
    const HandShake shake(mix(seed, 900 + static_cast<std::uint64_t>(i)), 0.003, 0.2);
    camera.cam_from_world = [path, shake](double t_s) { return shake.at(t_s) * cam_from_world(path.at(t_s)); };
    out.cameras.push_back(camera);
  }
  return out;
}

}  // namespace coslam::sim
