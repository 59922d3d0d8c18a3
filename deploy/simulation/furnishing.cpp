// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
// What hangs on walls and lies on floors, and the walls and floors.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "deploy/simulation/furniture.h"

namespace coslam::sim {
namespace {

using Eigen::Vector3d;

constexpr double kPrintTexelM = 0.002;

double wall_tone(MaterialKind kind) {
  switch (kind) {
    case MaterialKind::kBrick:
      return 0.34;
    case MaterialKind::kPlanks:
      return 0.42;
    case MaterialKind::kTiles:
      return 0.55;
    default:
      return 0.62;
  }
}

// What stands or hangs at one place of a wall; returns how wide it is.
double add_group(WorldBuilder& b, const WallFront& wall, double left_m, int kind) {
  switch (kind) {
    case 0: {
      const double width = b.random().uniform(0.9, 1.2);
      add_bookcase(b, wall.at(left_m + width / 2, 0), width, b.random().uniform(1.6, 2.1), 0.3);
      return width;
    }
    case 1:
      add_print(b, wall.at(left_m + 0.35, 1.35), 0.65, 0.9, MaterialKind::kPoster);
      add_carton(b, wall.at(left_m + 0.35, 0), {0.5, 0.4, 0.45});
      return 0.75;
    case 2:
      add_sideboard(b, wall.at(left_m + 0.7, 0), 1.4, 0.42, 0.78);
      add_vase(b, wall.at(left_m + 0.35, 0.78, 0.08), 0.1, 0.36);
      add_book_stack(b, wall.at(left_m + 0.95, 0.78, 0.1), 6);
      add_print(b, wall.at(left_m + 0.75, 1.4), 0.9, 0.65, MaterialKind::kPicture);
      return 1.45;
    case 3:
      add_plant(b, wall.at(left_m + 0.4, 0, 0.1), b.random().uniform(1.2, 1.6));
      return 0.8;
    case 4:
      add_pinboard(b, wall.at(left_m + 0.5, 1.0), 0.95, 1.0);
      return 1.0;
    default:
      add_table(b, wall.at(left_m + 0.7, 0), 1.35, 0.6, 0.74);
      add_monitor(b, wall.at(left_m + 0.55, 0.74, 0.1));
      add_print(b, wall.at(left_m + 1.05, 1.4), 0.5, 0.7, MaterialKind::kPoster);
      return 1.4;
  }
}

}  // namespace

Placement WallFront::at(double along_m, double z_m, double out_m) const {
  const double turn = turn_deg * std::numbers::pi / 180.0, c = std::cos(turn), s = std::sin(turn);
  return {x_m + c * along_m + s * out_m, y_m + s * along_m - c * out_m, z_m, turn_deg};
}

void furnish_wall(WorldBuilder& b, const WallFront& wall, double from_m, double to_m) {
  constexpr int kGroups = 6;
  constexpr double kWidestM = 1.5;
  int kind = b.random().index(kGroups);
  for (double left = from_m + 0.2; left + kWidestM < to_m; left += b.random().uniform(0.15, 0.4)) {
    left += add_group(b, wall, left, kind);
    kind = (kind + 1) % kGroups;
  }
}

void add_print(WorldBuilder& b, const Placement& at, double width_m, double height_m, MaterialKind kind) {
  b.begin(at);
  const double thickness = kind == MaterialKind::kPicture ? 0.03 : 0.006;
  const std::size_t first = b.world().facets.size();
  const Material front = b.material(kind, b.random().uniform(0.7, 0.9));
  b.box({-width_m / 2, -thickness, 0}, {width_m / 2, 0, height_m}, b.material(MaterialKind::kPaint, 0.3), front);
  b.world().facets[first].texel_m = kPrintTexelM;
}

void add_tag(WorldBuilder& b, const Placement& at, double side_m) {
  constexpr double kThicknessM = 0.004, kTagTexelM = 0.001;
  b.begin(at);
  const double sheet_m = side_m * (kTagCells + 2) / kTagCells;
  const std::size_t first = b.world().facets.size();
  const Material front = b.material(MaterialKind::kTag, 0.85);
  b.box({-sheet_m / 2, -kThicknessM, 0}, {sheet_m / 2, 0, sheet_m}, b.material(MaterialKind::kPaint, 0.8), front);
  b.world().facets[first].texel_m = kTagTexelM;
}

void add_window(WorldBuilder& b, const Placement& at, double width_m, double height_m, double radiance) {
  constexpr double kBarM = 0.05, kFrameM = 0.07;
  b.begin(at);
  const double half = width_m / 2;
  Facet& view =
      b.rect({-half, -0.01, height_m}, {width_m, 0, 0}, {0, 0, -height_m}, b.material(MaterialKind::kFoliage, 0.5));
  view.emission = 0.8F;
  const Material paint = b.material(MaterialKind::kPaint, 0.8);
  for (int i = 0; i <= 2; ++i) {
    const double x = -half + i * (width_m - kBarM) / 2;
    b.box({x, -kFrameM, 0}, {x + kBarM, 0, height_m}, paint);
    const double z = i * (height_m - kBarM) / 2;
    b.box({-half, -kFrameM, z}, {half, 0, z + kBarM}, paint);
  }
  b.box({-half - 0.08, -0.22, -0.04}, {half + 0.08, 0, 0}, b.material(MaterialKind::kWood, 0.6));
  b.light({-half, -kFrameM - 0.02, height_m}, {width_m, 0, 0}, {0, 0, -height_m}, radiance);
}

void add_pinboard(WorldBuilder& b, const Placement& at, double width_m, double height_m) {
  b.begin(at);
  const Material front = b.material(MaterialKind::kCarton, 0.4);
  b.box({-width_m / 2, -0.02, 0}, {width_m / 2, 0, height_m}, b.material(MaterialKind::kWood, 0.5), front);
  Random& random = b.random();
  const MaterialKind kinds[] = {MaterialKind::kNewspaper, MaterialKind::kPoster, MaterialKind::kPicture};
  const int columns = std::max(1, static_cast<int>(width_m / 0.27)),
            rows = std::max(1, static_cast<int>(height_m / 0.3));
  for (int i = 0; i < columns * rows; ++i) {
    const int column = i % columns, row = i / columns;
    const double x = -width_m / 2 + (column + 0.5) * width_m / columns + random.uniform(-0.03, 0.03);
    const double z = (row + 0.5) * height_m / rows + random.uniform(-0.03, 0.03);
    const double w = random.uniform(0.13, 0.22), h = random.uniform(0.15, 0.26), tilt = random.uniform(-0.15, 0.15);
    const double lift = 0.022 + 0.0005 * i;
    Facet& note = b.rect({x - w / 2, -lift, z + h / 2}, {w, 0, tilt * w}, {tilt * h, 0, -h},
                         b.material(kinds[random.index(3)], random.uniform(0.6, 0.9)));
    note.texel_m = kPrintTexelM;
  }
}

void add_rug(WorldBuilder& b, const Placement& at, double width_m, double depth_m) {
  b.begin(at);
  b.rect({-width_m / 2, 0, 0.008}, {width_m, 0, 0}, {0, -depth_m, 0}, b.material(MaterialKind::kRug, 0.35));
}

void add_shell(WorldBuilder& b, const RoomShell& s) {
  const double width = s.x1_m - s.x0_m, depth = s.y1_m - s.y0_m;
  const Vector3d down(0, 0, -s.height_m);
  const auto wall = [&](const Vector3d& corner, const Vector3d& edge_u, MaterialKind kind) {
    b.begin({});
    b.rect(corner, edge_u, down, b.material(kind, wall_tone(kind)));
  };
  wall({s.x0_m, s.y1_m, s.height_m}, {width, 0, 0}, s.north);
  wall({s.x1_m, s.y1_m, s.height_m}, {0, -depth, 0}, s.east);
  wall({s.x1_m, s.y0_m, s.height_m}, {-width, 0, 0}, s.south);
  wall({s.x0_m, s.y0_m, s.height_m}, {0, depth, 0}, s.west);
  b.begin({});
  b.rect({s.x0_m, s.y1_m, 0}, {width, 0, 0}, {0, -depth, 0}, b.material(s.floor, 0.38));
  b.begin({});
  b.rect({s.x0_m, s.y0_m, s.height_m}, {width, 0, 0}, {0, depth, 0}, b.material(MaterialKind::kCeiling, 0.75)).texel_m =
      0.004;
}

}  // namespace coslam::sim
