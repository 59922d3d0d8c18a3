// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/simulation/vehicle.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "deploy/simulation/noise.h"
#include "deploy/simulation/person.h"

namespace coslam::sim {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector2d;
using Eigen::Vector3d;

// Seen from some metres away.
constexpr double kVehicleTexelM = 0.008;

class Materials {
 public:
  explicit Materials(std::uint64_t seed) : random_(seed) {}
  Material operator()(MaterialKind kind, double tone) {
    return {kind, static_cast<std::uint32_t>(random_.next() >> 32), static_cast<float>(tone)};
  }
  double uniform(double low, double high) { return random_.uniform(low, high); }

 private:
  Random random_;
};

Rigid3 on_ground(const RoadPlace& place) {
  return {Quaterniond(AngleAxisd(place.heading_rad, Vector3d::UnitZ())), {place.at.x(), place.at.y(), 0}};
}

// Around an axle along y.
void add_wheel(Mesh& mesh, double radius_m, double half_width_m, const Material& material) {
  const Rigid3 axle(Quaterniond(AngleAxisd(-0.5 * std::numbers::pi, Vector3d::UnitX())), Vector3d::Zero());
  add_loft(mesh, axle, {{{-half_width_m, radius_m, radius_m}, {half_width_m, radius_m, radius_m}}, 0.02, 0.02},
           material);
}

Quaterniond rolled(double way_m, double radius_m) {
  return Quaterniond(AngleAxisd(way_m / radius_m, Vector3d::UnitY()));
}

constexpr double kCarWheelM = 0.31;
constexpr double kCarAxleX[2] = {-1.3, 1.3}, kCarAxleY[2] = {-0.78, 0.78};

std::vector<Mesh> car_parts(std::uint64_t seed) {
  using enum MaterialKind;
  Materials drawn(mix(seed, 81));
  std::vector<Mesh> out(5);
  Mesh& car = out[0];
  const Rigid3 origin;
  constexpr double kLong = kCarHalfLengthM, kWide = kCarHalfWidthM, kPlate = 0.03;
  const Material paint = drawn(kPaint, drawn.uniform(0.15, 0.7)), glass = drawn(kPicture, 0.3);
  add_box(car, origin, {-kLong + kPlate, -kWide + kPlate, 0.3}, {kLong - kPlate, kWide - kPlate, 0.86}, paint,
          drawn(kScreen, 0.4));
  add_box(car, origin, {-1.75, -0.76, 0.86}, {0.75, 0.76, 1.46}, paint, glass);
  // Number plate and lamps behind, the grille, the windows, and what is printed on the doors.
  add_box(car, origin, {-kLong, -0.8, 0.42}, {-kLong + kPlate, 0.8, 0.82}, drawn(kNewspaper, 0.5), paint);
  add_box(car, origin, {kLong - kPlate, -0.8, 0.4}, {kLong, 0.8, 0.8}, drawn(kStripedCloth, 0.4),
          drawn(kNewspaper, 0.4));
  add_box(car, origin, {-1.78, -0.68, 0.95}, {-1.75, 0.68, 1.38}, glass, glass);
  for (const double side : {-1.0, 1.0}) {
    const double inner = side * (kWide - kPlate), outer = side * kWide;
    add_box(car, origin, {-1.0, std::min(inner, outer), 0.4}, {1.0, std::max(inner, outer), 0.8}, drawn(kPoster, 0.7),
            paint);
    const double pane = side * 0.76, out_of_it = side * 0.78;
    add_box(car, origin, {-1.5, std::min(pane, out_of_it), 0.95}, {0.5, std::max(pane, out_of_it), 1.38}, glass, glass);
  }
  for (std::size_t i = 1; i < out.size(); ++i) add_wheel(out[i], kCarWheelM, 0.09, drawn(kStripedCloth, 0.25));
  for (Mesh& mesh : out) {
    for (Skin& skin : mesh.skins) skin.texel_m = kVehicleTexelM;
  }
  return out;
}

constexpr double kBikeWheelM = 0.34, kBikeAxleX[2] = {-0.52, 0.52};
constexpr double kPedalX = -0.05, kPedalZ = 0.28, kCrankM = 0.16, kWayATurnM = 5;

// Frame and two wheels; those who ride come before them.
std::vector<Mesh> bicycle_parts(std::uint64_t seed) {
  using enum MaterialKind;
  Materials drawn(mix(seed, 82));
  std::vector<Mesh> out(3);
  const Rigid3 origin;
  const Material paint = drawn(kPaint, drawn.uniform(0.2, 0.6));
  const auto bar = [&](const Vector3d& low, const Vector3d& high) { add_box(out[0], origin, low, high, paint, paint); };
  bar({-0.5, -0.02, 0.33}, {0.0, 0.02, 0.37});
  bar({-0.22, -0.02, 0.3}, {-0.18, 0.02, 0.9});
  bar({-0.2, -0.02, 0.74}, {0.42, 0.02, 0.78});
  bar({0.42, -0.02, 0.34}, {0.46, 0.02, 1.02});
  bar({0.4, -0.26, 1.0}, {0.44, 0.26, 1.04});
  add_box(out[0], origin, {-0.62, -0.2, 0.72}, {-0.3, 0.2, 0.98}, drawn(kPoster, 0.5), drawn(kCarton, 0.4));  // its bag
  for (std::size_t i = 1; i < out.size(); ++i) add_wheel(out[i], kBikeWheelM, 0.025, drawn(kStripedCloth, 0.3));
  return out;
}

Posture riding(const Rigid3& world_from_bike, double rolled_m) {
  const double turn = 2 * std::numbers::pi * rolled_m / kWayATurnM;
  Posture out;
  out.world_from_pelvis = world_from_bike * Rigid3(Quaterniond(AngleAxisd(0.25, Vector3d::UnitY())), {-0.2, 0, 0.98});
  out.torso.pitch_rad = 0.4;
  out.head.pitch_rad = -0.5;
  for (std::size_t side = 0; side < 2; ++side) {
    const double a = turn + (side == 0 ? 0 : std::numbers::pi), y = side == 0 ? 0.1 : -0.1;
    const Vector3d pedal(kPedalX + kCrankM * std::cos(a), y, kPedalZ - kCrankM * std::sin(a) + kAnkleM);
    out.world_from_feet[side] = world_from_bike * Rigid3(Quaterniond::Identity(), pedal);
    out.arms[side] = {1.35, 0.15, 0, 0.25};
  }
  return out;
}

}  // namespace

Body make_car(std::uint64_t seed, RoadMotion motion) {
  return {car_parts(seed),
          [motion = std::move(motion)](double t_s) {
            const RoadPlace place = motion(t_s);
            const Rigid3 car = on_ground(place);
            std::vector<Rigid3> out{car};
            for (const double x : kCarAxleX) {
              for (const double y : kCarAxleY) {
                out.push_back(car * Rigid3(rolled(place.rolled_m, kCarWheelM), {x, y, kCarWheelM}));
              }
            }
            return out;
          },
          "car"};
}

Body make_cyclist(std::uint64_t seed, RoadMotion motion) {
  std::vector<Mesh> parts = person_parts(seed);
  for (Mesh& part : bicycle_parts(seed)) parts.push_back(std::move(part));
  return {std::move(parts),
          [motion = std::move(motion)](double t_s) {
            const RoadPlace place = motion(t_s);
            const Rigid3 bike = on_ground(place);
            std::vector<Rigid3> out = place_person(riding(bike, place.rolled_m));
            out.push_back(bike);
            for (const double x : kBikeAxleX) {
              out.push_back(bike * Rigid3(rolled(place.rolled_m, kBikeWheelM), {x, 0, kBikeWheelM}));
            }
            return out;
          },
          "cyclist"};
}

Drive::Drive(const std::function<double(double)>& limit_m_s, double accelerate_m_s2, double end_s) {
  constexpr double kLookM = 0.25;
  // What still lets it brake in time: the limits ahead, from each place to as far as it needs to stand still.
  const auto may_m_s = [&](double way_m) {
    double out = limit_m_s(way_m);
    for (double ahead = 0; ahead < out * out / (2 * accelerate_m_s2); ahead += kLookM) {
      const double limit = limit_m_s(way_m + ahead);
      out = std::min(out, std::sqrt(limit * limit + 2 * accelerate_m_s2 * ahead));
    }
    return out;
  };
  double way = 0, speed = 0;
  for (double t = 0; t <= end_s; t += kStepS) {
    way_m_.push_back(way);
    speed_m_s_.push_back(speed);
    const double change = accelerate_m_s2 * kStepS;
    const double next = std::clamp(may_m_s(way), std::max(0.0, speed - change), speed + change);
    way += 0.5 * (speed + next) * kStepS;
    speed = next;
  }
}

double Drive::way_m(double t_s) const {
  if (t_s <= 0) return 0;
  const double steps = t_s / kStepS;
  const auto last = way_m_.size() - 1;
  if (steps >= static_cast<double>(last)) {
    return way_m_[last] + speed_m_s_[last] * (t_s - static_cast<double>(last) * kStepS);
  }
  const auto i = static_cast<std::size_t>(steps);
  const double in_it_s = t_s - static_cast<double>(i) * kStepS;
  const double gain_m_s2 = (speed_m_s_[i + 1] - speed_m_s_[i]) / kStepS;
  return way_m_[i] + in_it_s * (speed_m_s_[i] + 0.5 * gain_m_s2 * in_it_s);
}

}  // namespace coslam::sim
