// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/simulation/outdoor.h"

#include <cmath>
#include <numbers>

namespace coslam::sim {
namespace {

using Eigen::Vector3d;

constexpr double kStreetPrintTexelM = 0.003;

void hang_on(WorldBuilder& b, const WallFront& wall, double along_m, int kind) {
  const std::size_t first = b.world().facets.size();
  const double width = b.random().uniform(0.7, 1.1), height = b.random().uniform(0.9, 1.3);
  const double z = b.random().uniform(0.8, 1.3);
  switch (kind) {
    case 0:
    case 4:
      add_house_window(b, wall.at(along_m, z), width, height);
      return;
    case 1:
      add_print(b, wall.at(along_m, z), width, height, MaterialKind::kPoster);
      break;
    case 2:
      add_coarse_block(b, wall.at(along_m, 0), {0.35, 0.18, 3.2},
                       b.random().index(2) == 0 ? MaterialKind::kBrick : MaterialKind::kPlaster, 0.4);
      return;
    case 3:
      add_pinboard(b, wall.at(along_m, z), width, height);
      break;
    default:
      add_print(b, wall.at(along_m, z), width, 0.8 * height, MaterialKind::kPicture);
  }
  coarsen(b, first, kStreetPrintTexelM, 0.06);
}

void stand_at_foot(WorldBuilder& b, const WallFront& wall, double along_m, int kind) {
  const Placement at = wall.at(along_m, 0, 0.1);
  const Placement askew{at.x_m, at.y_m, 0, at.turn_deg + b.random().uniform(-15, 15)};
  switch (kind) {
    case 0:
      add_plant(b, at, b.random().uniform(0.9, 1.4));
      break;
    case 1:
      add_carton(b, askew, {0.5, 0.4, 0.45});
      if (b.random().index(2) == 0) add_carton(b, {askew.x_m, askew.y_m, 0.45, at.turn_deg}, {0.38, 0.3, 0.32});
      break;
    case 2:
      add_coarse_block(b, at, {1.1, 0.35, 0.45}, MaterialKind::kPlanks, 0.4);
      add_vase(b, {at.x_m, at.y_m, 0.45, at.turn_deg}, 0.1, 0.35);
      break;
    case 3:
      add_coarse_block(b, at, {1.0, 0.4, 0.7}, MaterialKind::kFoliage, 0.5);
      break;
    default:
      add_vase(b, at, 0.22, 0.8);
  }
}

}  // namespace

void coarsen(WorldBuilder& b, std::size_t first, double texel_m, double light_cell_m) {
  for (std::size_t i = first; i < b.world().facets.size(); ++i) {
    b.world().facets[i].texel_m = texel_m;
    b.world().facets[i].light_cell_m = light_cell_m;
  }
}

void add_coarse_block(WorldBuilder& b, const Placement& at, const Vector3d& size_m, MaterialKind kind, double tone) {
  const std::size_t first = b.world().facets.size();
  add_block(b, at, size_m, kind, tone);
  coarsen(b, first, kWallTexelM, kWallLightM);
}

void add_horizon(WorldBuilder& b, double far_x_m, double far_y_m, double sky_m) {
  constexpr double kTreesM = 8, kTexelM = 0.03, kLightM = 1;
  const std::size_t first = b.world().facets.size();
  const Vector3d corners[5] = {{-far_x_m, far_y_m, 0},
                               {far_x_m, far_y_m, 0},
                               {far_x_m, -far_y_m, 0},
                               {-far_x_m, -far_y_m, 0},
                               {-far_x_m, far_y_m, 0}};
  for (int i = 0; i < 4; ++i) {
    const Vector3d along = corners[i + 1] - corners[i], up(0, 0, 1);
    b.begin({});
    b.rect(corners[i] + kTreesM * up, along, -kTreesM * up, b.material(MaterialKind::kFoliage, 0.5)).emission = 0.3F;
    b.rect(corners[i] + sky_m * up, along, -(sky_m - kTreesM) * up, b.material(MaterialKind::kLamp, 0.6)).emission =
        0.8F;
  }
  b.begin({});
  b.rect({-far_x_m, -far_y_m, sky_m}, {2 * far_x_m, 0, 0}, {0, 2 * far_y_m, 0}, b.material(MaterialKind::kLamp, 0.6))
      .emission = 0.8F;
  b.begin({});
  b.rect({-far_x_m, far_y_m, -0.02}, {2 * far_x_m, 0, 0}, {0, -2 * far_y_m, 0},
         b.material(MaterialKind::kPlaster, 0.4));
  coarsen(b, first, kTexelM, kLightM);
}

void add_sun(WorldBuilder& b, const Vector3d& from, double sunlight) {
  constexpr double kSizeM = 2.2;
  b.begin({});
  b.light(from, {kSizeM, 0, 0}, {0, kSizeM, 0}, sunlight * std::numbers::pi * from.z() * from.z() / (kSizeM * kSizeM));
}

void add_house_window(WorldBuilder& b, const Placement& at, double width_m, double height_m) {
  const std::size_t first = b.world().facets.size();
  b.begin(at);
  const double half = width_m / 2;
  b.box({-half - 0.08, -0.06, -0.08}, {half + 0.08, 0, height_m + 0.08}, b.material(MaterialKind::kPaint, 0.75));
  b.rect({-half, -0.065, height_m}, {width_m, 0, 0}, {0, 0, -height_m}, b.material(MaterialKind::kFoliage, 0.35));
  b.box({-0.03, -0.09, 0}, {0.03, -0.06, height_m}, b.material(MaterialKind::kPaint, 0.75));
  coarsen(b, first, kWallTexelM, kWallLightM);
}

void add_tree(WorldBuilder& b, double x_m, double y_m, double radius_m) {
  const std::size_t first = b.world().facets.size();
  const double height = b.random().uniform(2.9, 3.6);
  b.begin({x_m, y_m, 0, b.random().uniform(0, 90)});
  b.cylinder({0, 0, 0}, radius_m, height + 0.5, 12, b.material(MaterialKind::kWood, b.random().uniform(0.22, 0.4)));
  for (int i = 0; i < 16; ++i) {
    const double size = b.random().uniform(0.2, 0.55);
    const double up = b.random().uniform(0.2, 1.6), y = b.random().uniform(-0.9, 0.9),
                 x = b.random().uniform(-0.9, 0.9);
    const Vector3d middle(x, y, height + up);
    b.box(middle - Vector3d::Constant(size), middle + Vector3d::Constant(size),
          b.material(MaterialKind::kFoliage, b.random().uniform(0.4, 0.6)));
  }
  coarsen(b, first, kWallTexelM, kWallLightM);
}

void add_sign_board(WorldBuilder& b, const Placement& at, double width_m, double height_m) {
  constexpr double kFootM = 0.9, kPostM = 0.09;
  const std::size_t first = b.world().facets.size();
  b.begin(at);
  const double half = width_m / 2;
  for (const double x : {-half, half - kPostM}) {
    b.box({x, -kPostM, 0}, {x + kPostM, 0, kFootM + height_m}, b.material(MaterialKind::kWood, 0.3));
  }
  const Material front = b.material(MaterialKind::kPoster, 0.85);
  b.box({-half, -kPostM - 0.03, kFootM}, {half, -kPostM, kFootM + height_m}, b.material(MaterialKind::kPaint, 0.4),
        front);
  coarsen(b, first, kStreetPrintTexelM, 0.06);
}

void furnish_front(WorldBuilder& b, const WallFront& wall, double from_m, double to_m) {
  constexpr int kHung = 6, kStanding = 5;
  Random& random = b.random();
  int hung = random.index(kHung), standing = random.index(kStanding);
  for (double along = from_m + random.uniform(0.6, 0.9); along < to_m - 0.5; along += random.uniform(1.25, 1.75)) {
    hang_on(b, wall, along, hung);
    hung = (hung + 1) % kHung;
    if (random.uniform(0, 1) < 0.55 && along + 0.7 < to_m) {
      stand_at_foot(b, wall, along + random.uniform(-0.2, 0.6), standing);
      standing = (standing + 1) % kStanding;
    }
  }
}

}  // namespace coslam::sim
