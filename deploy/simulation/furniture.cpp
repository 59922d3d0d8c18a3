// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/simulation/furniture.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace coslam::sim {
namespace {

using Eigen::Vector3d;

// Books side by side from x0 to x1, standing on z with their spines towards -y.
void fill_board(WorldBuilder& b, double x0, double x1, double z, double clear_m, double depth_m) {
  Random& random = b.random();
  double x = x0 + 0.01;
  while (x < x1 - 0.06) {
    if (random.uniform(0, 1) < 0.12) {  // a gap, or something small in it
      const double gap = std::min(random.uniform(0.08, 0.2), x1 - x - 0.01);
      const double size = std::min(gap, clear_m) * random.uniform(0.5, 0.85);
      const Vector3d low(x, -depth_m * random.uniform(0.75, 0.95), z);
      b.box(low, low + Vector3d(size, size * 0.6, size), b.material(MaterialKind::kCarton, random.uniform(0.2, 0.7)));
      x += gap;
      continue;
    }
    const double thickness = random.uniform(0.018, 0.06), height = clear_m * random.uniform(0.62, 0.95);
    const double set_back = random.uniform(0.02, 0.07);
    const double tone = random.uniform(0.05, 0.85);
    const Material spine = b.material(MaterialKind::kBookSpine, tone);
    b.box({x, -depth_m + set_back, z}, {x + thickness, -0.03, z + height}, b.material(MaterialKind::kPages, 0.6),
          spine);
    const std::size_t pages = b.world().facets.size() - 5;  // all but the spine, and mostly hidden
    for (std::size_t i = pages; i < pages + 5; ++i) b.world().facets[i].texel_m = 0.005;
    x += thickness + 0.001;
  }
}

// Four legs below a top of the given size, its back at y = 0.
void legs(WorldBuilder& b, double width_m, double depth_m, double height_m, double thickness_m, const Material& m) {
  const double x = width_m / 2 - thickness_m, y = depth_m - thickness_m;
  for (const double side : {-x - thickness_m, x}) {
    for (const double back : {-thickness_m, -y - thickness_m}) {
      b.box({side, back, 0}, {side + thickness_m, back + thickness_m, height_m}, m);
    }
  }
}

}  // namespace

void add_bookcase(WorldBuilder& b, const Placement& at, double width_m, double height_m, double depth_m) {
  constexpr double kBoardM = 0.022;
  b.begin(at);
  const Material wood = b.material(MaterialKind::kWood, b.random().uniform(0.25, 0.5));
  const double half = width_m / 2;
  b.box({-half, -depth_m, 0}, {-half + kBoardM, 0, height_m}, wood);
  b.box({half - kBoardM, -depth_m, 0}, {half, 0, height_m}, wood);
  b.box({-half, -0.012, 0}, {half, 0, height_m}, wood);
  const int boards = std::max(2, static_cast<int>(std::lround(height_m / 0.36)));
  const double step = (height_m - kBoardM) / boards;
  for (int i = 0; i <= boards; ++i) {
    const double z = i * step;
    b.box({-half + kBoardM, -depth_m, z}, {half - kBoardM, -0.012, z + kBoardM}, wood);
    if (i < boards) fill_board(b, -half + kBoardM, half - kBoardM, z + kBoardM, step - kBoardM - 0.02, depth_m);
  }
}

void add_table(WorldBuilder& b, const Placement& at, double width_m, double depth_m, double height_m) {
  b.begin(at);
  const Material wood = b.material(MaterialKind::kWood, b.random().uniform(0.3, 0.6));
  b.box({-width_m / 2, -depth_m, height_m - 0.035}, {width_m / 2, 0, height_m}, wood);
  legs(b, width_m, depth_m, height_m - 0.035, 0.05, wood);
}

void add_sideboard(WorldBuilder& b, const Placement& at, double width_m, double depth_m, double height_m) {
  b.begin(at);
  const double tone = b.random().uniform(0.3, 0.6);
  const Material wood = b.material(MaterialKind::kWood, tone);
  b.box({-width_m / 2, -depth_m, 0}, {width_m / 2, 0, height_m}, wood);
  const int doors = std::max(2, static_cast<int>(std::lround(width_m / 0.45)));
  const double door = width_m / doors;
  for (int i = 0; i < doors; ++i) {
    const double x = -width_m / 2 + i * door;
    const Material front = b.material(i % 2 == 0 ? MaterialKind::kWood : MaterialKind::kPaint, tone * 1.2);
    b.box({x + 0.012, -depth_m - 0.018, 0.06}, {x + door - 0.012, -depth_m, height_m - 0.03}, front);
    const double knob = x + door * 0.85;
    b.box({knob, -depth_m - 0.045, height_m * 0.6}, {knob + 0.025, -depth_m - 0.018, height_m * 0.6 + 0.1},
          b.material(MaterialKind::kPaint, 0.1));
  }
}

void add_chair(WorldBuilder& b, const Placement& at) {
  constexpr double kSeatM = 0.45, kSizeM = 0.44;
  b.begin(at);
  const Material wood = b.material(MaterialKind::kWood, b.random().uniform(0.2, 0.55));
  legs(b, kSizeM, kSizeM, kSeatM, 0.035, wood);
  b.box({-kSizeM / 2, -kSizeM, kSeatM}, {kSizeM / 2, 0, kSeatM + 0.04}, b.material(MaterialKind::kFabric, 0.4));
  for (const double x : {-kSizeM / 2, kSizeM / 2 - 0.035}) b.box({x, -0.03, kSeatM}, {x + 0.035, 0, 0.92}, wood);
  for (int i = 0; i < 4; ++i) {
    const double z = 0.55 + 0.1 * i;
    b.box({-kSizeM / 2, -0.025, z}, {kSizeM / 2, -0.005, z + 0.055}, wood);
  }
}

void add_sofa(WorldBuilder& b, const Placement& at, double width_m) {
  constexpr double kDepthM = 0.85;
  b.begin(at);
  const Material fabric = b.material(MaterialKind::kFabric, b.random().uniform(0.25, 0.5));
  const double half = width_m / 2;
  b.box({-half, -kDepthM, 0.08}, {half, 0, 0.40}, fabric);
  b.box({-half, -0.22, 0.40}, {half, 0, 0.85}, fabric);
  b.box({-half, -kDepthM, 0.40}, {-half + 0.18, -0.22, 0.60}, fabric);
  b.box({half - 0.18, -kDepthM, 0.40}, {half, -0.22, 0.60}, fabric);
  const int cushions = static_cast<int>(std::lround(width_m / 0.6));
  const double step = (width_m - 0.36) / cushions;
  for (int i = 0; i < cushions; ++i) {
    const double x = -half + 0.18 + i * step;
    const Material cover = b.material(i % 2 == 0 ? MaterialKind::kRug : MaterialKind::kFabric, 0.3 + 0.12 * i);
    b.box({x + 0.05, -0.36, 0.42}, {x + step - 0.05, -0.24, 0.78}, cover);
  }
}

void add_carton(WorldBuilder& b, const Placement& at, const Vector3d& size_m) {
  b.begin(at);
  const Material board = b.material(MaterialKind::kCarton, b.random().uniform(0.3, 0.55));
  b.box({-size_m.x() / 2, -size_m.y(), 0}, {size_m.x() / 2, 0, size_m.z()}, board);
}

void add_plant(WorldBuilder& b, const Placement& at, double height_m) {
  b.begin(at);
  const double pot = 0.16 + 0.06 * height_m, pot_height = 0.25 * std::min(1.2, height_m);
  b.cylinder({0, -pot, 0}, pot, pot_height, 16, b.material(MaterialKind::kTiles, 0.4));
  b.cylinder({0, -pot, pot_height}, 0.02, 0.7 * (height_m - pot_height), 6, b.material(MaterialKind::kWood, 0.3));
  Random& random = b.random();
  const double crown = 0.5 * (height_m - pot_height), middle = pot_height + 0.55 * (height_m - pot_height);
  const int leaves = static_cast<int>(130 * height_m);
  for (int i = 0; i < leaves; ++i) {
    const double angle = random.uniform(0, 2 * std::numbers::pi), lift = random.uniform(-0.9, 0.9);
    const double reach = 0.62 * crown * std::sqrt(random.uniform(0.02, 1.0)) * std::sqrt(1 - lift * lift);
    const Vector3d out(std::cos(angle), std::sin(angle), random.uniform(-0.5, 0.6));
    const double tilt_y = random.uniform(-1, 1), tilt_x = random.uniform(-1, 1);
    const Vector3d side = out.cross(Vector3d::UnitZ() + 0.4 * Vector3d(tilt_x, tilt_y, 0));
    const double length = random.uniform(0.07, 0.16);
    const Vector3d stem(reach * std::cos(angle), -pot + reach * std::sin(angle), middle + lift * crown);
    Facet& leaf = b.rect(stem, length * out.normalized(), 0.42 * length * side.normalized(),
                         b.material(MaterialKind::kLeaf, random.uniform(0.12, 0.5)));
    leaf.texel_m = 0.002;
  }
}

void add_monitor(WorldBuilder& b, const Placement& at) {
  b.begin(at);
  const Material plastic = b.material(MaterialKind::kPaint, 0.15);
  b.box({-0.12, -0.2, 0}, {0.12, 0, 0.02}, plastic);
  b.box({-0.02, -0.08, 0.02}, {0.02, -0.04, 0.15}, plastic);
  b.box({-0.29, -0.13, 0.12}, {0.29, -0.10, 0.48}, plastic, b.material(MaterialKind::kScreen, 0.5));
  b.box({-0.24, -0.48, 0}, {0.24, -0.33, 0.025}, b.material(MaterialKind::kNewspaper, 0.5));
}

void add_book_stack(WorldBuilder& b, const Placement& at, int books) {
  b.begin(at);
  Random& random = b.random();
  double z = 0;
  for (int i = 0; i < books; ++i) {
    const double width = random.uniform(0.2, 0.32), depth = random.uniform(0.15, 0.22),
                 thick = random.uniform(0.02, 0.05);
    const double x = random.uniform(-0.02, 0.02);
    const Material pages = b.material(MaterialKind::kCarton, random.uniform(0.1, 0.8));
    const Material cover = b.material(MaterialKind::kPoster, random.uniform(0.4, 0.9));
    b.box({x - width / 2, -depth, z}, {x + width / 2, 0, z + thick}, cover, pages);
    z += thick;
  }
}

void add_vase(WorldBuilder& b, const Placement& at, double radius_m, double height_m) {
  b.begin(at);
  const Material glaze = b.material(b.random().index(2) == 0 ? MaterialKind::kTiles : MaterialKind::kRug, 0.5);
  b.cylinder({0, -radius_m, 0}, radius_m, height_m * 0.75, 20, glaze);
  b.cylinder({0, -radius_m, height_m * 0.75}, radius_m * 0.5, height_m * 0.25, 14, glaze);
}

void add_floor_lamp(WorldBuilder& b, const Placement& at) {
  b.begin(at);
  const Material metal = b.material(MaterialKind::kPaint, 0.12);
  b.cylinder({0, -0.15, 0}, 0.15, 0.03, 16, metal);
  b.cylinder({0, -0.15, 0.03}, 0.014, 1.4, 8, metal);
  b.cylinder({0, -0.15, 1.4}, 0.19, 0.28, 20, b.material(MaterialKind::kRug, 0.75));
}

void add_block(WorldBuilder& b, const Placement& at, const Vector3d& size_m, MaterialKind kind, double tone) {
  b.begin(at);
  b.box({-size_m.x() / 2, -size_m.y(), 0}, {size_m.x() / 2, 0, size_m.z()}, b.material(kind, tone));
}

}  // namespace coslam::sim
