// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/simulation/gait.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "deploy/simulation/cart.h"

namespace coslam::sim::gait_test {
namespace {

GroundPath oval() {
  return GroundPath(
      {{-1.9, 0.9}, {-1.2, 0.0}, {0.0, -0.25}, {1.2, 0.0}, {1.9, 0.9}, {1.3, 2.0}, {0.0, 2.4}, {-1.3, 2.0}});
}

double lowest_z(const Mesh& mesh, const Rigid3& world_from_part) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const MeshVertex& v : mesh.vertices) {
    lowest = std::min(lowest, (world_from_part * v.point.cast<double>()).z());
  }
  return lowest;
}

TEST(GroundPath, IsClosedAndMeasuredInMetres) {
  const GroundPath path = oval();
  EXPECT_NEAR((path.at(0) - path.at(path.length_m())).norm(), 0, 1e-9);
  EXPECT_NEAR((path.at(1) - path.at(1 + path.length_m())).norm(), 0, 1e-9);
  for (double d = 0; d < path.length_m(); d += 0.1) {
    EXPECT_NEAR((path.at(d + 0.01) - path.at(d)).norm(), 0.01, 2e-4) << d;
  }
}

TEST(Gait, BonesKeepTheirLengths) {
  const Gait gait(oval());
  for (double d = 0; d < gait.path().length_m(); d += 0.07) {
    const std::vector<Rigid3> parts = place_person(gait.at(d));
    const auto apart = [&](PersonPart a, PersonPart b) { return (parts[a].translation - parts[b].translation).norm(); };
    EXPECT_NEAR(apart(kLeftThigh, kLeftShank), kThighM, 1e-9);
    EXPECT_NEAR(apart(kRightThigh, kRightShank), kThighM, 1e-9);
    EXPECT_NEAR(apart(kLeftShank, kLeftFoot), kShankM, 1e-9);
    EXPECT_NEAR(apart(kRightShank, kRightFoot), kShankM, 1e-9);
    EXPECT_NEAR(apart(kLeftThigh, kRightThigh), 2 * kHipHalfM, 1e-9);
    EXPECT_NEAR(apart(kLeftUpperArm, kLeftForearm), kUpperArmM, 1e-9);
    for (const PersonPart shank : {kLeftShank, kRightShank}) {
      // The shank ends where the foot begins.
      const Eigen::Vector3d ankle = parts[shank] * Eigen::Vector3d(0, 0, -kShankM);
      EXPECT_NEAR((ankle - parts[shank + 2].translation).norm(), 0, 1e-9) << d;
    }
  }
}

TEST(Gait, OneFootIsAlwaysOnTheFloorAndNeitherIsInIt) {
  const Gait gait(oval());
  const std::vector<Mesh> meshes = person_parts(1);
  for (double d = 0; d < gait.path().length_m(); d += 0.05) {
    const std::vector<Rigid3> parts = place_person(gait.at(d));
    const double left = lowest_z(meshes[kLeftFoot], parts[kLeftFoot]);
    const double right = lowest_z(meshes[kRightFoot], parts[kRightFoot]);
    EXPECT_NEAR(std::min(left, right), 0, 0.02) << d;
    EXPECT_LT(std::max(left, right), 0.2) << d;
  }
}

TEST(Gait, AFootThatIsFlatOnTheFloorDoesNotSlide) {
  const Gait gait(oval());
  int flat = 0, all = 0;
  for (double d = 0; d < gait.path().length_m(); d += 0.02) {
    const std::vector<Rigid3> now = place_person(gait.at(d)), next = place_person(gait.at(d + 1e-3));
    for (const PersonPart foot : {kLeftFoot, kRightFoot}) {
      ++all;
      const Eigen::Vector3d up = now[foot].rotation * Eigen::Vector3d::UnitZ();
      if (up.z() < 1 - 1e-9 || now[foot].translation.z() > kAnkleM + 1e-3) continue;
      ++flat;
      EXPECT_LT((next[foot].translation - now[foot].translation).norm(), 2e-5) << d;  // of a millimetre walked
    }
  }
  EXPECT_GT(flat, 0.15 * all);
}

TEST(Gait, NothingJumps) {
  const Gait gait(oval());
  constexpr double kStepM = 1e-3;
  for (double d = 0; d < gait.path().length_m() + 1; d += 0.0037) {
    const std::vector<Rigid3> now = place_person(gait.at(d)), next = place_person(gait.at(d + kStepM));
    for (std::size_t i = 0; i < now.size(); ++i) {
      EXPECT_LT((next[i].translation - now[i].translation).norm(), 6 * kStepM) << "part " << i << " at " << d;
      EXPECT_LT(next[i].rotation.angularDistance(now[i].rotation), 12 * kStepM) << "part " << i << " at " << d;
    }
  }
}

TEST(Walk, RestsWithBothFeetDownAndWalksOn) {
  const Gait gait(oval());
  const Walk walk(gait, 1.2, 0.3, {{3.0, 1.5}, {7.0, 1.0}});
  double last = walk.distance_m(0), rested_s = 0;
  constexpr double kStepS = 0.01;
  for (double t = kStepS; t < 12; t += kStepS) {
    const double now = walk.distance_m(t);
    EXPECT_GE(now, last - 1e-9);
    if (now - last < 1e-6) rested_s += kStepS;
    last = now;
  }
  EXPECT_NEAR(rested_s, 2.5, 0.15);
  EXPECT_NEAR(last, 0.3 + 1.2 * (12 - 2.5 - 2 * 0.5), 0.05);
  EXPECT_NEAR(gait.rest_near(3.3), 3.3, 0.5 * gait.stride_m());
}

TEST(Cart, ItsWheelsRollOnTheFloor) {
  const Body cart = make_cart(1, {1, 2}, 90, [](double t_s) { return 0.5 * t_s; });
  const std::vector<Rigid3> now = cart.world_from_parts(1), next = cart.world_from_parts(1 + 1e-4);
  EXPECT_NEAR((now[0].translation - Eigen::Vector3d(1, 2.5, 0)).norm(), 0, 1e-9);
  for (std::size_t wheel = 1; wheel < now.size(); ++wheel) {
    EXPECT_NEAR(lowest_z(cart.parts[wheel], now[wheel]), 0, 2e-3);
    const Eigen::Vector3d touching = now[wheel].translation - Eigen::Vector3d(0, 0, kCartWheelM);
    const Eigen::Vector3d later = next[wheel] * (now[wheel].inverse() * touching);
    EXPECT_LT((later - touching).norm() / 1e-4, 1e-3);
  }
}

}  // namespace
}  // namespace coslam::sim::gait_test
