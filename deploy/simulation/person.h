// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "deploy/simulation/body.h"

namespace coslam::sim {

// Parts of a person. In its own frame each has its origin at the joint to the part before it, x to the front, y to the
// left and z up when the person stands straight.
enum PersonPart {
  kPelvis,  // the origin is the middle of the hip joints
  kTorso,
  kHead,
  kLeftUpperArm,
  kRightUpperArm,
  kLeftForearm,  // with the hand
  kRightForearm,
  kLeftThigh,
  kRightThigh,
  kLeftShank,
  kRightShank,
  kLeftFoot,
  kRightFoot,
  kPersonParts
};

// A person of 1.78 m. Lengths in metres.
inline constexpr double kThighM = 0.43, kShankM = 0.42, kAnkleM = 0.08, kHipHalfM = 0.09;
inline constexpr double kUpperArmM = 0.29, kForearmM = 0.25;
// Offsets of the heel and the ball of the foot from the ankle on the floor.
inline constexpr double kHeelM = -0.06, kBallM = 0.17;

struct ArmPosture {
  double swing_rad = 0;   // swing of the upper arm to the front
  double spread_rad = 0;  // away from the body
  double turn_rad = 0;    // turn of the forearm's plane inwards
  double elbow_rad = 0;   // 0 is straight
};

// Yaw to the left, pitch to the front, roll to the right.
struct Turn {
  double yaw_rad = 0, pitch_rad = 0, roll_rad = 0;
  Eigen::Quaterniond rotation() const;
};

// Left before right.
struct Posture {
  Rigid3 world_from_pelvis;
  Turn torso, head;  // relative to the part before
  std::array<ArmPosture, 2> arms;
  std::array<Rigid3, 2> world_from_feet;  // targets of the feet; the legs follow, as far as they reach
  double knee_lift = 0;                   // direction in which knees bend: 0 to the front, 1 up as well
};

// World from the parts in the order of PersonPart.
std::vector<Rigid3> place_person(const Posture& posture);

// A person in printed clothes. The seed draws the clothes.
std::vector<Mesh> person_parts(std::uint64_t seed);
Body make_person(std::uint64_t seed, std::function<Posture(double t_s)> posture);

}  // namespace coslam::sim
