// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/scene/motion.h"
#include "common/scene/outdoor.h"
#include "common/scene/simulated_scene.h"

namespace coslam::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;

// The way around the middle: a rectangle with round corners. From it it is kHalfWay to the houses in the middle and to
// those outside.
constexpr double kStraightX = 20.7, kStraightY = 11.2, kCornerM = 4.5, kHalfWay = 5.0;
constexpr double kWayX = kStraightX / 2 + kCornerM, kWayY = kStraightY / 2 + kCornerM;  // half of its sides
constexpr double kInnerX = kWayX - kHalfWay, kInnerY = kWayY - kHalfWay;
constexpr double kOuterX = kWayX + kHalfWay, kOuterY = kWayY + kHalfWay;
constexpr double kWallM = 5.0;  // height of what must not be looked over

// In the middle of each long side a house divides the way into two lanes, with a gate at both ends of each.
constexpr double kIslandX = 5.5, kIslandHalfM = 0.8, kLaneM = 2.9, kGateM = 2.8, kGateHighM = 2.8;

constexpr double kStartY = 3.2;  // on the west side, going south
constexpr double kSpeed_m_s = 1.6, kRiseS = 0.6, kRateHz = 20, kEndS = 1280 / kRateHz;

void add_ground(WorldBuilder& b) {
  const std::size_t first = b.world().facets.size();
  const double x = kOuterX + 1, y = kOuterY + 1;
  b.begin({});
  b.rect({-x, y, 0}, {2 * x, 0, 0}, {0, -2 * y, 0}, b.material(MaterialKind::kTiles, 0.42));
  b.begin({});
  b.rect({-3, kInnerY + 0.5, 0.01}, {6, 0, 0}, {0, -2 * kInnerY - 1, 0}, b.material(MaterialKind::kFoliage, 0.42));
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

void add_outer_houses(WorldBuilder& b) {
  constexpr double x = kOuterX, y = kOuterY;
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
void add_middle(WorldBuilder& b) {
  constexpr double kGarden = 3;
  using enum MaterialKind;
  constexpr double kWidth = kInnerX - kGarden;
  for (const double side : {-1.0, 1.0}) {
    const double x = side * 0.5 * (kInnerX + kGarden);
    add_coarse_block(b, {x, kInnerY, 0, 0}, {kWidth, 2 * kInnerY, kWallM + side}, side < 0 ? kPlaster : kBrick,
                     side < 0 ? 0.6 : 0.37);
    furnish_front(b, {x, -kInnerY, 0}, -kWidth / 2, kWidth / 2);
    furnish_front(b, {x, kInnerY, 180}, -kWidth / 2, kWidth / 2);
    furnish_front(b, {side * kInnerX, 0, side * 90}, -kInnerY, kInnerY);
    furnish_front(b, {side * kGarden, 0, -side * 90}, -kInnerY, kInnerY);
    add_tree(b, side * 1.4, side * 2.2, 0.2);
    add_coarse_block(b, {0, side * (kInnerY - 0.2) + 0.3, 0, 0}, {3.4, 0.6, 0.8}, kFoliage, 0.5);
    add_plant(b, {-side * 1.6, side * 3.6, 0, 0}, 1.3);
  }
  add_coarse_block(b, {0, 0.35, 0, 0}, {0.7, 0.7, 1.1}, kBrick, 0.4);
  add_vase(b, {0, 0.3, 1.1, 0}, 0.28, 1.1);
}

// A wall across the way at x, with a gate to each lane; `side` is that of the way.
void add_gates(WorldBuilder& b, double x, double side) {
  constexpr double kThickM = 0.3, kWide = kLaneM - kGateM / 2;  // half of the part between the gates
  const auto piece = [&](double from_y, double to_y, double low_z) {
    const Placement at{x, side * 0.5 * (from_y + to_y) + side * kWayY, low_z, 90};
    add_coarse_block(b, {at.x_m - kThickM / 2, at.y_m, low_z, 90}, {std::abs(to_y - from_y), kThickM, kWallM - low_z},
                     MaterialKind::kPlaster, 0.55);
  };
  piece(-kWide, kWide, 0);
  for (const double lane : {-1.0, 1.0}) {
    piece(lane * kWide, lane * (kLaneM + kGateM / 2), kGateHighM);
    piece(lane * (kLaneM + kGateM / 2), lane * kHalfWay, 0);
  }
  for (const double face : {-1.0, 1.0}) {
    const WallFront wall{x + face * kThickM / 2, side * kWayY, face * 90};
    add_print(b, wall.at(0.55, 1.1), 0.8, 1.1, MaterialKind::kPoster);
    add_pinboard(b, wall.at(-0.6, 1.0), 0.9, 1.0);
    for (const double lane : {-1.0, 1.0}) {
      add_print(b, wall.at(lane * kLaneM, kGateHighM + 0.25), 2.2, 0.9,
                lane < 0 ? MaterialKind::kPicture : MaterialKind::kPoster);
      add_print(b, wall.at(lane * (kHalfWay - 0.35), 1.2), 0.5, 0.8, MaterialKind::kPoster);
    }
  }
}

void add_island(WorldBuilder& b, double side) {
  const double y = side * kWayY;
  add_coarse_block(b, {0, y + kIslandHalfM, 0, 0}, {2 * kIslandX - 0.4, 2 * kIslandHalfM, kWallM},
                   side < 0 ? MaterialKind::kBrick : MaterialKind::kPlanks, 0.4);
  furnish_front(b, {0, y - kIslandHalfM, 0}, -kIslandX + 0.3, kIslandX - 0.3);
  furnish_front(b, {0, y + kIslandHalfM, 180}, -kIslandX + 0.3, kIslandX - 0.3);
  for (const double x : {-kIslandX, kIslandX}) add_gates(b, x, side);
}

void furnish_way(WorldBuilder& b) {
  add_sign_board(b, {-kWayX + 3.6, kStartY - 5.2, 0, -146}, 2.6, 1.7);
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      add_tree(b, x * (kOuterX - 1.8), y * (kOuterY - 1.8), 0.22);
      add_plant(b, {x * (kInnerX + 0.9), y * (kInnerY + 0.9), 0, 0}, 1.3);
      add_coarse_block(b, {x * (kOuterX - 3.4), y * (kOuterY - 1.2), 0, 0}, {2.2, 0.7, 0.9}, MaterialKind::kFoliage,
                       0.45);
    }
  }
  add_tree(b, kWayX + 2.7, -2.0, 0.18);
  add_tree(b, kWayX - 2.8, 2.4, 0.16);
  add_tree(b, -kWayX - 2.6, -1.0, 0.2);
  add_coarse_block(b, {kWayX + 2.4, 3.5, 0, -80}, {1.6, 0.5, 0.9}, MaterialKind::kBrick, 0.4);
}

World courtyard_world(std::uint64_t seed) {
  WorldBuilder b(mix(seed, 6));
  add_ground(b);
  add_horizon(b, 44, 40, 60);
  add_outer_houses(b);
  add_middle(b);
  for (const double side : {-1.0, 1.0}) add_island(b, side);
  furnish_way(b);
  add_sun(b, {16, -21, 50}, 0.9);
  b.world().ambient = 0.5;
  return b.world();
}

// A place on the way by the distance from its start, counter-clockwise.
struct WayPlace {
  Vector2d at, outward;
  double heading_deg = 0;  // goes on beyond 360
};

WayPlace way_place(double gone_m) {
  constexpr double kArcM = kCornerM * kPi / 2;
  // Straight pieces and corners in the order of the way, from the start on the west side.
  double left = gone_m, heading_deg = -90;
  Vector2d at(-kWayX, kStartY);
  const double straights[] = {kStartY + kStraightY / 2, kStraightX, kStraightY, kStraightX, kStraightY / 2 - kStartY};
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

constexpr double way_length() { return 2 * kStraightX + 2 * kStraightY + 2 * kPi * kCornerM; }

// 1 between the gates of a side, 0 away from them.
double in_lanes(const WayPlace& place, double side) {
  constexpr double kFullM = kIslandX + 0.3, kOffM = kFullM + 6.5;
  if (place.at.y() * side < kWayY - 3) return 0;
  const double x = (kOffM - std::abs(place.at.x())) / (kOffM - kFullM), t = std::clamp(x, 0.0, 1.0);
  return t * t * t * (t * (t * 6 - 15) + 10);
}

// Which lane a camera takes (outer +1) and its place in the lane, of the south and the north side.
struct Lanes {
  double south, south_place, north, north_place;
};
constexpr Lanes kLanes[4] = {{-1, -0.3, 1, -0.3}, {-1, 0.3, -1, -0.3}, {1, -0.3, 1, 0.3}, {1, 0.3, -1, 0.3}};

ViewPath camera_path(int index) {
  constexpr int kWaypoints = 72;
  const Lanes& lanes = kLanes[index % 4];
  const double place = (index % 4) - 1.5, row = static_cast<double>(index / 4);
  std::vector<ViewPose> out;
  for (int i = 0; i < kWaypoints; ++i) {
    const double share = static_cast<double>(i) / kWaypoints;
    const WayPlace way = way_place(share * way_length());
    const double south = in_lanes(way, -1), north = in_lanes(way, 1);
    // Side by side, and on the other side after half the way: each goes inside of the others as long as outside.
    const double off_m = (1 - south - north) * 0.52 * place * std::cos(2 * kPi * share) +
                         south * (lanes.south * kLaneM + lanes.south_place) +
                         north * (lanes.north * kLaneM + lanes.north_place);
    const Vector2d at = way.at + off_m * way.outward;
    out.push_back(
        {{at.x(), at.y(), 1.5 + 0.05 * place + 0.14 * row}, way.heading_deg + 36 + 12 * (south + north), -4, 0});
  }
  return {out, 360};
}

// As a small aircraft flies: along the way, swaying.
ViewPose courtyard_view(const ViewPath& path, int index, double t_s) {
  const double share = kSpeed_m_s * eased_journey(t_s, kEndS, kRiseS) / (kSpeed_m_s * (kEndS - 2 * kRiseS));
  const double phase = 1.7 * index;
  const auto off = [&](double times, double shift) {
    return std::sin(2 * kPi * times * share + phase + shift) - std::sin(phase + shift);
  };
  ViewPose out = path.at(share * path.length_m());
  out.position_m += Vector3d(0.09 * off(13, 0.3), 0.09 * off(11, 1.1), 0.10 * off(15, 2.0));
  out.heading_deg += 5 * off(10, 0.9);
  out.pitch_deg += 2 * off(14, 1.6);
  out.roll_deg += 2 * off(12, 2.4);
  return out;
}

}  // namespace

SceneDescription describe_courtyard(std::uint64_t seed, int cameras) {
  SceneDescription out;
  out.world = courtyard_world(seed);
  out.rate_hz = kRateHz;
  out.frames = static_cast<int>(std::lround(kEndS * kRateHz));
  for (int i = 0; i < cameras; ++i) {
    SceneCamera camera;
    camera.sensor = simulated_sensor(i, seed);
    const ViewPath path = camera_path(i);
    const HandShake shake(mix(seed, 700 + static_cast<std::uint64_t>(i)), 0.005, 0.25);
    camera.cam_from_world = [i, path, shake](double t_s) {
      return shake.at(t_s) * cam_from_world(courtyard_view(path, i, t_s));
    };
    out.cameras.push_back(camera);
  }
  return out;
}

}  // namespace coslam::sim
