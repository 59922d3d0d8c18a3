// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "deploy/simulation/gait.h"
#include "deploy/simulation/outdoor.h"
#include "deploy/simulation/simulated_scene.h"
#include "deploy/simulation/vehicle.h"

namespace coslam::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;

// The street goes around a block of houses: half sides of its middle line, and the radius of its corners.
constexpr double kHalfX = 70, kHalfY = 35, kCornerM = 14;
constexpr double kKerbM = 5.2, kFrontM = 7;  // from its middle
constexpr double kLaneM = 1.75, kBicycleLaneM = 3.7, kWalkM = 6.1;
constexpr double kRateHz = 10, kTop_m_s = 60 / 3.6, kSideways_m_s2 = 4.5, kAccelerate_m_s2 = 3;
constexpr double kApartM = 10, kBeyondM = 30;
// The camera is on the front of the car: nothing of the car is in its view.
constexpr double kCameraAheadM = kCarHalfLengthM + 0.4, kCameraM = 1.25;
constexpr double kHouseTexelM = 0.015, kHouseLightM = 0.3, kRoadTexelM = 0.02;

// The middle of the street, counter-clockwise, from a place in the west of the south side.
ViewPath street() {
  constexpr double kStartX = -45, kStepM = 4;
  constexpr double kLongM = 2 * (kHalfX - kCornerM), kShortM = 2 * (kHalfY - kCornerM), kArcM = kCornerM * kPi / 2;
  constexpr double kRoundM = 2 * kLongM + 2 * kShortM + 4 * kArcM;
  const auto place = [&](double gone_m) -> ViewPose {
    double left = gone_m + kStartX + kLongM / 2;
    if (left >= kRoundM) left -= kRoundM;
    Vector2d at(-kLongM / 2, -kHalfY);
    for (int side = 0;; ++side) {
      const double heading = side * kPi / 2, straight_m = side % 2 == 0 ? kLongM : kShortM;
      const Vector2d ahead(std::cos(heading), std::sin(heading)), in(-ahead.y(), ahead.x());
      const double straight = std::min(left, straight_m);
      at += straight * ahead;
      if (left <= straight_m) return {{at.x(), at.y(), 0}, heading * 180 / kPi, 0, 0};
      left -= straight_m;
      const double turned = std::min(left, kArcM) / kCornerM;
      at += kCornerM * (std::sin(turned) * ahead + (1 - std::cos(turned)) * in);
      if (left <= kArcM) return {{at.x(), at.y(), 0}, (heading + turned) * 180 / kPi, 0, 0};
      left -= kArcM;
    }
  };
  const int count = static_cast<int>(std::lround(kRoundM / kStepM));
  std::vector<ViewPose> out;
  for (int i = 0; i < count; ++i) {
    out.push_back(place(kRoundM * i / count));
    // The start lies within the south side, which the way comes back to after a whole turn.
    if (i > 0 && out.back().heading_deg < out[out.size() - 2].heading_deg - 180) out.back().heading_deg += 360;
  }
  return {out, 360};
}

// On the right of the middle line for who drives counter-clockwise.
RoadPlace on_street(const ViewPath& way, double gone_m, double right_m) {
  const ViewPose at = way.at(gone_m);
  const double heading = at.heading_deg * kPi / 180;
  return {at.position_m.head<2>() + right_m * Vector2d(std::sin(heading), -std::cos(heading)), heading, gone_m};
}

void add_parked_car(WorldBuilder& b, const Placement& at) {
  const std::size_t first = b.world().facets.size();
  b.begin(at);
  const Material paint = b.material(MaterialKind::kPaint, b.random().uniform(0.15, 0.7));
  b.box({-kCarHalfLengthM, -2 * kCarHalfWidthM, 0.2}, {kCarHalfLengthM, 0, 0.86}, paint,
        b.material(MaterialKind::kPoster, 0.6));
  b.box({-1.6, -1.9 * kCarHalfWidthM, 0.86}, {0.8, -0.1 * kCarHalfWidthM, 1.46}, paint,
        b.material(MaterialKind::kPicture, 0.4));
  coarsen(b, first, kHouseTexelM, kHouseLightM);
}

// Houses along a line, with gaps, and windows on upper floors.
void add_houses(WorldBuilder& b, const WallFront& wall, double half_m) {
  using enum MaterialKind;
  constexpr MaterialKind kKinds[3] = {kBrick, kPlaster, kPlanks};
  constexpr double kDepthM = 4, kGapM = 4, kFloorM = 2.9;
  Random& random = b.random();
  for (double from = -half_m; from < half_m - 3;) {
    const double to = std::min(half_m, from + random.uniform(8, 14)), high_m = random.uniform(5.5, 11);
    const Placement back = wall.at(0, 0, -random.uniform(0, 0.7));
    const WallFront front{back.x_m, back.y_m, wall.turn_deg};
    const double tone = random.uniform(0.34, 0.6);
    const MaterialKind kind = kKinds[random.index(3)];
    add_coarse_block(b, front.at(0.5 * (from + to), 0, -kDepthM), {to - from, kDepthM, high_m}, kind, tone);
    furnish_front(b, front, from, to);
    for (double z = 1 + kFloorM; z + 1.6 < high_m; z += kFloorM) {
      for (double along = from + 1.2; along < to - 0.9; along += random.uniform(1.9, 2.6)) {
        const double window_high_m = random.uniform(1.1, 1.5), window_wide_m = random.uniform(0.8, 1.2);
        add_house_window(b, front.at(along, z), window_wide_m, window_high_m);
      }
    }
    from = to;
    if (random.index(3) == 0) {
      const Placement tree = wall.at(from + kGapM / 2, 0, -1.5);
      add_tree(b, tree.x_m, tree.y_m, 0.22);
      from += kGapM;
    }
  }
}

// Pavement, marks of the lanes, trees and parked cars along a straight piece of the street, which is `in_m` in front of
// the line of the houses outside.
void furnish_road(WorldBuilder& b, const WallFront& outside, double half_m) {
  constexpr double kPavementM = kFrontM - kKerbM;
  for (double along = -half_m; along < half_m; along += 6) {
    const std::size_t first = b.world().facets.size();
    b.begin(outside.at(along, 0, kFrontM));
    b.rect({-1, 0.06, 0.012}, {2, 0, 0}, {0, -0.12, 0}, b.material(MaterialKind::kPaint, 0.85));
    b.begin(outside.at(along, 0, kFrontM - kKerbM + 0.35));
    b.rect({-3, 0.05, 0.012}, {6, 0, 0}, {0, -0.1, 0}, b.material(MaterialKind::kPaint, 0.8));
    coarsen(b, first, kRoadTexelM, kHouseLightM);
  }
  for (const double out_m : {0.0, kFrontM + kKerbM}) {
    const std::size_t first = b.world().facets.size();
    b.begin(outside.at(0, 0, out_m + kPavementM));
    b.box({-half_m, 0, 0}, {half_m, kPavementM, 0.1}, b.material(MaterialKind::kTiles, 0.45));
    coarsen(b, first, kRoadTexelM, kHouseLightM);
  }
  Random& random = b.random();
  for (double along = -half_m + 2; along < half_m - 2; along += random.uniform(10, 17)) {
    const Placement at = outside.at(along, 0, 1.3);
    add_tree(b, at.x_m, at.y_m, 0.16);
  }
  for (double along = -half_m + 4; along < half_m - 4; along += random.uniform(6, 14)) {
    add_parked_car(b, outside.at(along, 0, kFrontM + kKerbM - 2 * kCarHalfWidthM - 0.1));
  }
}

World street_world(std::uint64_t seed) {
  WorldBuilder b(mix(seed, 9));
  constexpr double kFarX = 130, kFarY = 100;
  b.begin({});
  const double x = kHalfX + kFrontM + 1, y = kHalfY + kFrontM + 1;
  b.rect({-x, y, 0}, {2 * x, 0, 0}, {0, -2 * y, 0}, b.material(MaterialKind::kPlaster, 0.33));
  coarsen(b, 0, kRoadTexelM, 0.5);
  add_horizon(b, kFarX, kFarY, 60);
  const std::size_t houses = b.world().facets.size();
  const double outer_x = kHalfX + kFrontM, outer_y = kHalfY + kFrontM, inner_x = kHalfX - kFrontM,
               inner_y = kHalfY - kFrontM;
  const WallFront outside[] = {{0, outer_y, 0}, {outer_x, 0, -90}, {0, -outer_y, 180}, {-outer_x, 0, 90}};
  const WallFront inside[] = {{0, inner_y, 180}, {inner_x, 0, 90}, {0, -inner_y, 0}, {-inner_x, 0, -90}};
  for (int i = 0; i < 4; ++i) {
    const bool along_x = i % 2 == 0;
    add_houses(b, outside[i], along_x ? outer_x : outer_y);
    add_houses(b, inside[i], (along_x ? inner_x : inner_y) - 1.5);
  }
  for (std::size_t i = houses; i < b.world().facets.size(); ++i) {
    Facet& f = b.world().facets[i];
    f.texel_m = std::max(f.texel_m, f.width_m() < 2 ? kHouseTexelM / 2 : kHouseTexelM);
    f.light_cell_m = std::max(f.light_cell_m, kHouseLightM);
  }
  for (int i = 0; i < 4; ++i) furnish_road(b, outside[i], (i % 2 == 0 ? kHalfX : kHalfY) - kCornerM);
  add_sun(b, {40, -60, 90}, 1.5);
  // Closes the seam below the horizon.
  b.begin({});
  b.rect({-kFarX - 2, kFarY + 2, -0.03}, {2 * kFarX + 4, 0, 0}, {0, -2 * kFarY - 4, 0},
         b.material(MaterialKind::kPaint, 0.4))
      .texel_m = 0.1;
  b.world().facets.back().light_cell_m = 4;
  b.world().ambient = 0.8;
  return b.world();
}

// As fast as the street allows around all cars of the column.
Drive drive_of(const ViewPath& way, int cars, double end_s) {
  const auto limit_m_s = [&](double gone_m) {
    constexpr double kOverM = 3, kStepM = 2;
    double sharpest = 0;  // 1/m
    for (double at = gone_m - kApartM * (cars - 1) - kOverM; at <= gone_m + kOverM; at += kStepM) {
      const double turn_deg = way.at(at + kOverM).heading_deg - way.at(at - kOverM).heading_deg;
      sharpest = std::max(sharpest, std::abs(turn_deg) * kPi / 180 / (2 * kOverM));
    }
    return std::min(kTop_m_s, std::sqrt(kSideways_m_s2 / std::max(sharpest, 1e-3)));
  };
  return {limit_m_s, kAccelerate_m_s2, end_s};
}

// Somebody who steps off the pavement, is over the street four seconds before the first car comes, and stays there.
Body crosser(std::uint64_t seed, const ViewPath& way, double at_m, double car_comes_s) {
  constexpr double kSpeed_m_s = 1.3, kOverS = 4, kStaysS = 30;
  std::vector<Vector2d> around;
  for (double right = -kWalkM; right <= kWalkM; right += 2) around.push_back(on_street(way, at_m, right).at);
  for (double right = kWalkM; right >= -kWalkM; right -= 2) around.push_back(on_street(way, at_m + 1.8, right).at);
  const Gait gait{GroundPath(around)};
  const double over_m = kWalkM + kKerbM, by_then_m = kSpeed_m_s * (car_comes_s - kOverS);
  const Walk walk(gait, kSpeed_m_s, over_m - by_then_m, {{by_then_m + 0.6, kStaysS}});
  return make_person(seed, [walk](double t_s) { return walk.at(t_s); });
}

// Up and down on the pavement of the houses inside.
Body stroller(std::uint64_t seed, const ViewPath& way, double at_m, double speed_m_s) {
  constexpr double kLongM = 24, kStepM = 2;
  std::vector<Vector2d> around;
  for (double on = 0; on <= kLongM; on += kStepM) around.push_back(on_street(way, at_m + on, -kWalkM + 0.3).at);
  for (double on = kLongM; on >= 0; on -= kStepM) around.push_back(on_street(way, at_m + on, -kWalkM - 0.3).at);
  const Walk walk(Gait{GroundPath(around)}, speed_m_s, 3, {});
  return make_person(seed, [walk](double t_s) { return walk.at(t_s); });
}

void add_traffic(std::vector<Body>& bodies, std::uint64_t seed, const ViewPath& way) {
  constexpr int kOncoming = 5, kCyclists = 3;
  constexpr double kOncoming_m_s = 10, kCyclistsFromM[kCyclists] = {30, 150, 262};
  for (int i = 0; i < kOncoming; ++i) {
    const double from_m = 55 + i * way.length_m() / kOncoming;
    bodies.push_back(make_car(mix(seed, 720 + static_cast<std::uint64_t>(i)), [way, from_m](double t_s) {
      const double gone_m = kOncoming_m_s * t_s;
      RoadPlace out = on_street(way, from_m - gone_m, -kLaneM);
      return RoadPlace{out.at, out.heading_rad + kPi, gone_m};
    }));
  }
  for (int i = 0; i < kCyclists; ++i) {
    const double speed_m_s = 4.6 + 0.4 * i, from_m = kCyclistsFromM[i];
    bodies.push_back(make_cyclist(mix(seed, 740 + static_cast<std::uint64_t>(i)), [way, speed_m_s, from_m](double t_s) {
      return on_street(way, from_m + speed_m_s * t_s, kBicycleLaneM);
    }));
  }
}

}  // namespace

SceneDescription describe_street(std::uint64_t seed, int cameras) {
  constexpr double kLongestS = 90, kFirstM = 60;  // the first crossing
  SceneDescription out;
  out.world = street_world(seed);
  out.rate_hz = kRateHz;
  const auto way = std::make_shared<const ViewPath>(street());
  const auto drive = std::make_shared<const Drive>(drive_of(*way, cameras, kLongestS));
  const auto when_s = [&](double gone_m) {
    double t = 0;
    while (drive->way_m(t) < gone_m) t += 0.1;
    return t;
  };
  out.frames = static_cast<int>(std::lround(when_s(way->length_m() + kBeyondM) * kRateHz));
  for (int i = 0; i < cameras; ++i) {
    const double behind_m = kApartM * i;
    const RoadMotion car = [way, drive, behind_m](double t_s) {
      return on_street(*way, drive->way_m(t_s) - behind_m, kLaneM);
    };
    out.bodies.push_back(make_car(mix(seed, 700 + static_cast<std::uint64_t>(i)), car));
    SceneCamera camera;
    camera.sensor = simulated_sensor(i, seed);
    const HandShake shake(mix(seed, 850 + static_cast<std::uint64_t>(i)), 0.003, 0.1);
    const double up_m = 0.04 * (i % 3);
    camera.cam_from_world = [car, shake, up_m](double t_s) {
      const RoadPlace place = car(t_s);
      const Vector2d ahead(std::cos(place.heading_rad), std::sin(place.heading_rad)),
          at = place.at + kCameraAheadM * ahead;
      return shake.at(t_s) * cam_from_world({{at.x(), at.y(), kCameraM + up_m}, place.heading_rad * 180 / kPi, -1, 0});
    };
    out.cameras.push_back(camera);
  }
  add_traffic(out.bodies, seed, *way);
  const double places_m[] = {kFirstM, 0.55 * way->length_m(), 0.8 * way->length_m()};
  for (int i = 0; i < 3; ++i) {
    out.bodies.push_back(
        crosser(mix(seed, 760 + static_cast<std::uint64_t>(i)), *way, places_m[i], when_s(places_m[i])));
  }
  for (const double at_m : {40.0, 215.0}) {
    out.bodies.push_back(stroller(mix(seed, 780 + static_cast<std::uint64_t>(at_m)), *way, at_m, 1.25));
  }
  return out;
}

}  // namespace coslam::sim
