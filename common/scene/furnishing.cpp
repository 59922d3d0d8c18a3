// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
// What hangs on walls and lies on floors, and the walls and floors.
#include <algorithm>

#include "common/scene/furniture.h"

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

}  // namespace

void add_print(WorldBuilder& b, const Placement& at, double width_m, double height_m, MaterialKind kind) {
  b.begin(at);
  const double thickness = kind == MaterialKind::kPicture ? 0.03 : 0.006;
  const std::size_t first = b.world().facets.size();
  b.box({-width_m / 2, -thickness, 0}, {width_m / 2, 0, height_m}, b.material(MaterialKind::kPaint, 0.3),
        b.material(kind, b.random().uniform(0.7, 0.9)));
  b.world().facets[first].texel_m = kPrintTexelM;
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
  b.box({-width_m / 2, -0.02, 0}, {width_m / 2, 0, height_m}, b.material(MaterialKind::kWood, 0.5),
        b.material(MaterialKind::kCarton, 0.4));
  Random& random = b.random();
  const MaterialKind kinds[] = {MaterialKind::kNewspaper, MaterialKind::kPoster, MaterialKind::kPicture};
  const int columns = std::max(1, static_cast<int>(width_m / 0.27)),
            rows = std::max(1, static_cast<int>(height_m / 0.3));
  for (int i = 0; i < columns * rows; ++i) {
    const double x = -width_m / 2 + (i % columns + 0.5) * width_m / columns + random.uniform(-0.03, 0.03);
    const double z = (i / columns + 0.5) * height_m / rows + random.uniform(-0.03, 0.03);
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
