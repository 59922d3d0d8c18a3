// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/simulation/courtyard.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>

#include "deploy/simulation/noise.h"
#include "deploy/simulation/outdoor.h"

namespace coslam::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;

constexpr double kWallM = 5.0;  // height of what must not be looked over
constexpr double kIslandX = 5.5, kIslandHalfM = 0.8, kGateM = 2.8, kGateHighM = 2.8;
constexpr double kHalfWay = CourtyardPlan::kHalfWayM, kCornerM = CourtyardPlan::kCornerM,
                 kLaneM = CourtyardPlan::kLaneM;

void add_ground(WorldBuilder& b, const CourtyardPlan& p) {
  const std::size_t first = b.world().facets.size();
  const double x = p.outer_x() + 1, y = p.outer_y() + 1;
  b.begin({});
  b.rect({-x, y, 0}, {2 * x, 0, 0}, {0, -2 * y, 0}, b.material(MaterialKind::kTiles, 0.42));
  b.begin({});
  b.rect({-3, p.inner_y() + 0.5, 0.01}, {6, 0, 0}, {0, -2 * p.inner_y() - 1, 0},
         b.material(MaterialKind::kFoliage, 0.42));
  coarsen(b, first, kGroundTexelM, 0.1);
}

// Houses in a row along a wall, with a front each.
struct House {
  double from_m, to_m, back_m, height_m;  // back: how far behind the line of the wall the front stands
  MaterialKind kind;
  double tone;
};

void add_row(WorldBuilder& b, const WallFront& wall, std::initializer_list<House> houses) {
  constexpr double kDepthM = 0.8;
  for (const House& h : houses) {
    add_coarse_block(b, wall.at(0.5 * (h.from_m + h.to_m), 0, -h.back_m - kDepthM),
                     {h.to_m - h.from_m, kDepthM, h.height_m}, h.kind, h.tone);
    const Placement at = wall.at(0, 0, -h.back_m);
    furnish_front(b, {at.x_m, at.y_m, wall.turn_deg}, h.from_m, h.to_m);
  }
}

void add_outer_houses(WorldBuilder& b, const CourtyardPlan& p) {
  const double x = p.outer_x(), y = p.outer_y();
  using enum MaterialKind;
  add_row(b, {0, y, 0},
          {{-x, -8, 0, 6.5, kBrick, 0.36},
           {-8, 1, 0.5, 5, kPlaster, 0.6},
           {1, 9, 0, 7, kPlanks, 0.42},
           {9, x, 0.4, 5.5, kBrick, 0.42}});
  add_row(b, {x, 0, -90},
          {{-y, -4, 0.4, 6, kPlanks, 0.4}, {-4, 5, 0, 5, kBrick, 0.34}, {5, y, 0.6, 7, kPlaster, 0.55}});
  add_row(b, {0, -y, 180},
          {{-x, -9, 0, 5.5, kPlaster, 0.58},
           {-9, 0, 0.4, 6.5, kBrick, 0.38},
           {0, 8, 0, 5, kPlanks, 0.44},
           {8, x, 0.5, 6, kBrick, 0.36}});
  add_row(b, {-x, 0, 90}, {{-y, -5, 0.3, 6, kBrick, 0.4}, {-5, 4, 0, 7, kPlanks, 0.42}, {4, y, 0.5, 5, kPlaster, 0.6}});
}

// Two houses with a garden between them.
void add_middle(WorldBuilder& b, const CourtyardPlan& p) {
  constexpr double kGarden = 3;
  using enum MaterialKind;
  const double width = p.inner_x() - kGarden;
  for (const double side : {-1.0, 1.0}) {
    const double x = side * 0.5 * (p.inner_x() + kGarden);
    add_coarse_block(b, {x, p.inner_y(), 0, 0}, {width, 2 * p.inner_y(), kWallM + side}, side < 0 ? kPlaster : kBrick,
                     side < 0 ? 0.6 : 0.37);
    furnish_front(b, {x, -p.inner_y(), 0}, -width / 2, width / 2);
    furnish_front(b, {x, p.inner_y(), 180}, -width / 2, width / 2);
    furnish_front(b, {side * p.inner_x(), 0, side * 90}, -p.inner_y(), p.inner_y());
    furnish_front(b, {side * kGarden, 0, -side * 90}, -p.inner_y(), p.inner_y());
    add_tree(b, side * 1.4, side * 2.2, 0.2);
    add_coarse_block(b, {0, side * (p.inner_y() - 0.2) + 0.3, 0, 0}, {3.4, 0.6, 0.8}, kFoliage, 0.5);
    add_plant(b, {-side * 1.6, side * 3.6, 0, 0}, 1.3);
  }
  add_coarse_block(b, {0, 0.35, 0, 0}, {0.7, 0.7, 1.1}, kBrick, 0.4);
  add_vase(b, {0, 0.3, 1.1, 0}, 0.28, 1.1);
}

// A wall across the way at x, with a gate to each lane; `side` is that of the way.
void add_gates(WorldBuilder& b, const CourtyardPlan& p, double x, double side) {
  constexpr double kThickM = 0.3, kWide = kLaneM - kGateM / 2;  // half of the part between the gates
  const auto piece = [&](double from_y, double to_y, double low_z) {
    const Placement at{x, side * 0.5 * (from_y + to_y) + side * p.way_y(), low_z, 90};
    add_coarse_block(b, {at.x_m - kThickM / 2, at.y_m, low_z, 90}, {std::abs(to_y - from_y), kThickM, kWallM - low_z},
                     MaterialKind::kPlaster, 0.55);
  };
  piece(-kWide, kWide, 0);
  for (const double lane : {-1.0, 1.0}) {
    piece(lane * kWide, lane * (kLaneM + kGateM / 2), kGateHighM);
    piece(lane * (kLaneM + kGateM / 2), lane * kHalfWay, 0);
  }
  for (const double face : {-1.0, 1.0}) {
    const WallFront wall{x + face * kThickM / 2, side * p.way_y(), face * 90};
    add_print(b, wall.at(0.55, 1.1), 0.8, 1.1, MaterialKind::kPoster);
    add_pinboard(b, wall.at(-0.6, 1.0), 0.9, 1.0);
    for (const double lane : {-1.0, 1.0}) {
      add_print(b, wall.at(lane * kLaneM, kGateHighM + 0.25), 2.2, 0.9,
                lane < 0 ? MaterialKind::kPicture : MaterialKind::kPoster);
      add_print(b, wall.at(lane * (kHalfWay - 0.35), 1.2), 0.5, 0.8, MaterialKind::kPoster);
    }
  }
}

void add_island(WorldBuilder& b, const CourtyardPlan& p, double side) {
  const double y = side * p.way_y();
  add_coarse_block(b, {0, y + kIslandHalfM, 0, 0}, {2 * kIslandX - 0.4, 2 * kIslandHalfM, kWallM},
                   side < 0 ? MaterialKind::kBrick : MaterialKind::kPlanks, 0.4);
  furnish_front(b, {0, y - kIslandHalfM, 0}, -kIslandX + 0.3, kIslandX - 0.3);
  furnish_front(b, {0, y + kIslandHalfM, 180}, -kIslandX + 0.3, kIslandX - 0.3);
  for (const double x : {-kIslandX, kIslandX}) add_gates(b, p, x, side);
}

void furnish_way(WorldBuilder& b, const CourtyardPlan& p) {
  add_sign_board(b, {-p.way_x() + 3.6, p.start_y_m - 5.2, 0, -146}, 2.6, 1.7);
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      add_tree(b, x * (p.outer_x() - 1.8), y * (p.outer_y() - 1.8), 0.22);
      add_plant(b, {x * (p.inner_x() + 0.9), y * (p.inner_y() + 0.9), 0, 0}, 1.3);
      add_coarse_block(b, {x * (p.outer_x() - 3.4), y * (p.outer_y() - 1.2), 0, 0}, {2.2, 0.7, 0.9},
                       MaterialKind::kFoliage, 0.45);
    }
  }
  add_tree(b, p.way_x() + 2.7, -2.0, 0.18);
  add_tree(b, p.way_x() - 2.8, 2.4, 0.16);
  add_tree(b, -p.way_x() - 2.6, -1.0, 0.2);
  add_coarse_block(b, {p.way_x() + 2.4, 3.5, 0, -80}, {1.6, 0.5, 0.9}, MaterialKind::kBrick, 0.4);
}

}  // namespace

World courtyard_world(const CourtyardPlan& p, std::uint64_t seed) {
  WorldBuilder b(seed);
  add_ground(b, p);
  constexpr double kFarX = 44, kFarY = 40;
  add_horizon(b, kFarX, kFarY, 60);
  add_outer_houses(b, p);
  add_middle(b, p);
  for (const double side : {-1.0, 1.0}) add_island(b, p, side);
  furnish_way(b, p);
  add_sun(b, {16, -21, 50}, 0.9);
  // Closes the seam below the horizon.
  const double x = kFarX + 2, y = kFarY + 2;
  b.begin({});
  b.rect({-x, y, -0.03}, {2 * x, 0, 0}, {0, -2 * y, 0}, b.material(MaterialKind::kPaint, 0.4)).texel_m = 0.1;
  b.world().facets.back().light_cell_m = 2;
  b.world().ambient = 0.5;
  return b.world();
}

WayPlace way_place(const CourtyardPlan& p, double gone_m) {
  constexpr double kArcM = kCornerM * kPi / 2;
  // Straight pieces and corners in the order of the way, from the start on the west side.
  double left = gone_m, heading_deg = -90;
  Vector2d at(-p.way_x(), p.start_y_m);
  const double straights[] = {p.start_y_m + p.straight_y_m / 2, p.straight_x_m, p.straight_y_m, p.straight_x_m,
                              p.straight_y_m / 2 - p.start_y_m};
  for (int i = 0;; ++i) {
    const double heading = heading_deg * kPi / 180;
    const Vector2d ahead(std::cos(heading), std::sin(heading)), right(ahead.y(), -ahead.x());
    if (left <= straights[i] || i == 4) return {at + left * ahead, right, heading_deg};
    left -= straights[i];
    at += straights[i] * ahead;
    const Vector2d middle = at - kCornerM * right;
    const double turned = std::min(left, kArcM) / kCornerM;
    const Vector2d out = std::cos(turned) * right + std::sin(turned) * ahead;
    if (left <= kArcM) return {middle + kCornerM * out, out, heading_deg + turned * 180 / kPi};
    left -= kArcM;
    at = middle + kCornerM * out;
    heading_deg += 90;
  }
}

double CourtyardPlan::way_length_m() const { return 2 * straight_x_m + 2 * straight_y_m + 2 * kPi * kCornerM; }

double in_lanes(const CourtyardPlan& p, const WayPlace& place, double side) {
  constexpr double kFullM = kIslandX + 0.3, kOffM = kFullM + 6.5;
  if (place.at.y() * side < p.way_y() - 3) return 0;
  const double x = (kOffM - std::abs(place.at.x())) / (kOffM - kFullM), t = std::clamp(x, 0.0, 1.0);
  return t * t * t * (t * (t * 6 - 15) + 10);
}

}  // namespace coslam::sim
