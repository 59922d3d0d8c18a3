// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/simulation/person.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "deploy/simulation/noise.h"

namespace coslam::sim {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

const Vector3d kWaistInPelvis(0, 0, 0.12), kNeckInTorso(0, 0, 0.46);
constexpr double kShoulderHalfM = 0.205, kShoulderM = 0.40;

Quaterniond about(const Vector3d& axis, double angle_rad) { return Quaterniond(AngleAxisd(angle_rad, axis)); }

// x from y and z, all columns of unit length.
Quaterniond rotation_of(const Vector3d& y, const Vector3d& z) {
  Eigen::Matrix3d m;
  m << y.cross(z), y, z;
  return Quaterniond(m).normalized();
}

struct Leg {
  Rigid3 thigh, shank, foot;
};

// Bends the leg so that the ankle comes to where the foot wants it: two sides of a triangle and the third.
Leg reach(const Vector3d& hip, const Rigid3& world_from_foot, const Vector3d& knees_to) {
  const Vector3d way = world_from_foot.translation - hip;
  const double distance = std::clamp(way.norm(), 0.2, 0.9995 * (kThighM + kShankM));
  const Vector3d along = way.normalized(), left = knees_to.cross(along).normalized();
  const double foot_point = (kThighM * kThighM - kShankM * kShankM + distance * distance) / (2 * distance);
  const double bend = std::sqrt(std::max(0.0, kThighM * kThighM - foot_point * foot_point));
  const Vector3d knee = hip + foot_point * along + bend * along.cross(left);
  const Vector3d ankle = hip + distance * along;
  return {{rotation_of(left, (hip - knee).normalized()), hip},
          {rotation_of(left, (knee - ankle).normalized()), knee},
          {world_from_foot.rotation, ankle}};
}

}  // namespace

Quaterniond Turn::rotation() const {
  return about(Vector3d::UnitZ(), yaw_rad) * about(Vector3d::UnitY(), pitch_rad) * about(Vector3d::UnitX(), roll_rad);
}

std::vector<Rigid3> place_person(const Posture& p) {
  std::vector<Rigid3> out(kPersonParts);
  out[kPelvis] = p.world_from_pelvis;
  out[kTorso] = out[kPelvis] * Rigid3(p.torso.rotation(), kWaistInPelvis);
  out[kHead] = out[kTorso] * Rigid3(p.head.rotation(), kNeckInTorso);
  for (int side = 0; side < 2; ++side) {
    const double left = side == 0 ? 1 : -1;
    const auto pose_of = [&](PersonPart part) -> Rigid3& { return out[static_cast<std::size_t>(part + side)]; };
    const ArmPosture& arm = p.arms[static_cast<std::size_t>(side)];
    const Quaterniond upper = about(Vector3d::UnitY(), -arm.swing_rad) *
                              about(Vector3d::UnitX(), left * arm.spread_rad) *
                              about(Vector3d::UnitZ(), -left * arm.turn_rad);
    pose_of(kLeftUpperArm) = out[kTorso] * Rigid3(upper, {0, left * kShoulderHalfM, kShoulderM});
    pose_of(kLeftForearm) =
        pose_of(kLeftUpperArm) * Rigid3(about(Vector3d::UnitY(), -arm.elbow_rad), {0, 0, -kUpperArmM});
    const Rigid3& foot = p.world_from_feet[static_cast<std::size_t>(side)];
    const Vector3d ahead = out[kPelvis].rotation * Vector3d::UnitX() + foot.rotation * Vector3d::UnitX();
    const Leg leg = reach(out[kPelvis] * Vector3d(0, left * kHipHalfM, 0), foot,
                          ahead.normalized() + p.knee_lift * Vector3d::UnitZ());
    pose_of(kLeftThigh) = leg.thigh;
    pose_of(kLeftShank) = leg.shank;
    pose_of(kLeftFoot) = leg.foot;
  }
  return out;
}

// What a person is made of.
struct Outfit {
  Material shirt, trousers, head, hand, shoe;
};

Outfit draw_outfit(std::uint64_t seed) {
  Random random(mix(seed, 77));
  const auto drawn = [&](MaterialKind kind, double low, double high) {
    return Material{kind, static_cast<std::uint32_t>(random.next() >> 32),
                    static_cast<float>(random.uniform(low, high))};
  };
  const MaterialKind kinds[] = {MaterialKind::kCheckedCloth, MaterialKind::kPrintedCloth, MaterialKind::kStripedCloth};
  Outfit out;
  out.shirt = drawn(kinds[random.index(3)], 0.4, 0.6);
  out.trousers = drawn(MaterialKind::kDenim, 0.2, 0.4);
  out.head = drawn(MaterialKind::kFace, 0.4, 0.5);
  out.hand = drawn(MaterialKind::kHand, 0.4, 0.5);
  out.shoe = drawn(MaterialKind::kShoe, 0.1, 0.5);
  return out;
}

// Every piece of cloth shows another part of its pattern.
Material piece(Material m, std::uint32_t number) {
  m.seed += 131U * number;
  return m;
}

void add_trunk(std::vector<Mesh>& parts, const Outfit& outfit) {
  const Rigid3 origin;
  add_loft(parts[kPelvis], origin,
           {{{-0.11, 0.10, 0.15}, {0, 0.115, 0.175}, {0.08, 0.11, 0.16}, {0.17, 0.10, 0.145}}, 0.06, 0.03, 2.4},
           piece(outfit.trousers, 0));
  add_loft(parts[kTorso], origin,
           {{{-0.09, 0.105, 0.155},
             {0.05, 0.11, 0.15, 0.005},
             {0.2, 0.13, 0.175, 0.01},
             {0.34, 0.125, 0.195, 0.005},
             {0.44, 0.09, 0.17, -0.005},
             {0.49, 0.06, 0.07}},
            0.02,
            0.025,
            2.5},
           outfit.shirt);
  add_loft(parts[kHead], origin,
           {{{-0.02, 0.055, 0.055},
             {0.07, 0.055, 0.055},
             {0.10, 0.08, 0.065, 0.015},
             {0.17, 0.10, 0.078, 0.01},
             {0.24, 0.10, 0.08},
             {0.30, 0.09, 0.07}},
            0.01,
            0.075,
            2.2},
           outfit.head);
}

// side: 0 left, 1 right.
void add_arm(std::vector<Mesh>& parts, const Outfit& outfit, std::uint32_t side) {
  const Rigid3 origin;
  const auto part = [&](PersonPart left) -> Mesh& { return parts[static_cast<std::size_t>(left) + side]; };
  add_loft(part(kLeftUpperArm), origin,
           {{{-kUpperArmM - 0.03, 0.042, 0.042}, {-0.16, 0.052, 0.05}, {-0.03, 0.058, 0.055}, {0.045, 0.05, 0.05}},
            0.04,
            0.05},
           piece(outfit.shirt, 1 + side));
  add_loft(part(kLeftForearm), origin,
           {{{-kForearmM + 0.01, 0.032, 0.032}, {-0.12, 0.043, 0.042}, {0, 0.043, 0.042}, {0.03, 0.035, 0.035}},
            0.015,
            0.03},
           piece(outfit.shirt, 3 + side));
  add_loft(part(kLeftForearm), origin,
           {{{-kForearmM - 0.17, 0.025, 0.015}, {-kForearmM - 0.08, 0.043, 0.02}, {-kForearmM + 0.03, 0.025, 0.025}},
            0.03,
            0.01},
           piece(outfit.hand, side));
}

void add_leg(std::vector<Mesh>& parts, const Outfit& outfit, std::uint32_t side) {
  const Rigid3 origin;
  const auto part = [&](PersonPart left) -> Mesh& { return parts[static_cast<std::size_t>(left) + side]; };
  add_loft(
      part(kLeftThigh), origin,
      {{{-kThighM - 0.04, 0.057, 0.057}, {-0.3, 0.07, 0.068}, {-0.1, 0.088, 0.085}, {0.06, 0.08, 0.075}}, 0.05, 0.06},
      piece(outfit.trousers, 1 + side));
  add_loft(part(kLeftShank), origin,
           {{{-kShankM + 0.02, 0.048, 0.046},
             {-0.26, 0.058, 0.056, -0.01},
             {-0.12, 0.064, 0.06, -0.012},
             {0.03, 0.056, 0.054}},
            0.01,
            0.04},
           piece(outfit.trousers, 3 + side));
  // Turned so that its z axis is the foot's x axis; its x axis is down.
  const Rigid3 along(rotation_of(Vector3d::UnitY(), Vector3d::UnitX()), {0, 0, -0.02});
  add_loft(part(kLeftFoot), along,
           {{{kHeelM - 0.03, 0.055, 0.038, 0.005},
             {0.02, 0.065, 0.04, -0.005},
             {0.09, 0.04, 0.05, 0.02},
             {0.2, 0.026, 0.042, 0.034}},
            0.03,
            0.04,
            3},
           piece(outfit.shoe, side));
}

std::vector<Mesh> person_parts(std::uint64_t seed) {
  const Outfit outfit = draw_outfit(seed);
  std::vector<Mesh> parts(kPersonParts);
  add_trunk(parts, outfit);
  for (std::uint32_t side = 0; side < 2; ++side) {
    add_arm(parts, outfit, side);
    add_leg(parts, outfit, side);
  }
  return parts;
}

Body make_person(std::uint64_t seed, std::function<Posture(double t_s)> posture) {
  return {person_parts(seed), [posture = std::move(posture)](double t_s) { return place_person(posture(t_s)); },
          "person"};
}

}  // namespace coslam::sim
