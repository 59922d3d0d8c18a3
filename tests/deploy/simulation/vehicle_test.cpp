// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/simulation/vehicle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "deploy/simulation/person.h"

namespace coslam::sim::vehicle_test {
namespace {

using Eigen::Vector3d;

double lowest_z(const Mesh& mesh, const Rigid3& world_from_part) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const MeshVertex& v : mesh.vertices) {
    lowest = std::min(lowest, (world_from_part * v.point.cast<double>()).z());
  }
  return lowest;
}

// Along +y at 8 m/s.
RoadPlace northwards(double t_s) { return {{3, 8 * t_s}, std::numbers::pi / 2, 8 * t_s}; }

// Parts from `first` on are wheels: they stand on the ground and do not slide.
void expect_wheels_to_roll(const Body& body, std::size_t first) {
  constexpr double kStepS = 1e-4;
  const std::vector<Rigid3> now = body.world_from_parts(2), next = body.world_from_parts(2 + kStepS);
  ASSERT_EQ(now.size(), body.parts.size());
  for (std::size_t wheel = first; wheel < now.size(); ++wheel) {
    EXPECT_NEAR(lowest_z(body.parts[wheel], now[wheel]), 0, 5e-3);
    const Vector3d axle = now[wheel].translation, touching(axle.x(), axle.y(), 0);
    const Vector3d later = next[wheel] * (now[wheel].inverse() * touching);
    EXPECT_LT((later - touching).norm() / kStepS, 0.02) << "m/s, where it touches the ground";
  }
}

TEST(Car, GoesWhereItsMotionSaysOnWheelsThatRoll) {
  const Body car = make_car(1, northwards);
  EXPECT_EQ(car.kind, "car");
  const Rigid3 body = car.world_from_parts(2)[0];
  EXPECT_NEAR((body.translation - Vector3d(3, 16, 0)).norm(), 0, 1e-9);
  EXPECT_NEAR((body.rotation * Vector3d::UnitX() - Vector3d::UnitY()).norm(), 0, 1e-9) << "its front is ahead";
  expect_wheels_to_roll(car, 1);
}

TEST(Car, IsAsLargeAsItSays) {
  const Body car = make_car(1, northwards);
  Vector3d most = Vector3d::Zero();
  for (const MeshVertex& v : car.parts[0].vertices) most = most.cwiseMax(v.point.cast<double>().cwiseAbs());
  EXPECT_NEAR(most.x(), kCarHalfLengthM, 1e-6);
  EXPECT_NEAR(most.y(), kCarHalfWidthM, 1e-6);
}

TEST(Cyclist, RidesOnWheelsThatRollWithFeetOnThePedals) {
  const Body cyclist = make_cyclist(1, northwards);
  ASSERT_EQ(cyclist.parts.size(), static_cast<std::size_t>(kPersonParts) + 3);
  expect_wheels_to_roll(cyclist, kPersonParts + 1);
  for (double t_s = 0; t_s < 1; t_s += 0.05) {
    const std::vector<Rigid3> parts = cyclist.world_from_parts(t_s);
    const Rigid3 from_bike = parts[kPersonParts].inverse();
    const Vector3d left = from_bike * parts[kLeftFoot].translation, right = from_bike * parts[kRightFoot].translation;
    EXPECT_GT(std::min(left.z(), right.z()), 0.15) << "off the ground";
    EXPECT_NEAR(left.z() + right.z(), 2 * (0.28 + kAnkleM), 0.02) << "on opposite pedals";
    EXPECT_NEAR(left.x() + right.x(), 2 * -0.05, 0.02);
  }
}

TEST(Drive, StartsFromRestKeepsTheLimitsAndItsBrakes) {
  constexpr double kAccelerate = 3, kStepS = 0.02;
  const auto limit_m_s = [](double way_m) { return way_m > 60 && way_m < 80 ? 5.0 : 15.0; };
  const Drive drive(limit_m_s, kAccelerate, 20);
  EXPECT_EQ(drive.way_m(-1), 0);
  double last_m_s = 0, fastest_m_s = 0;
  for (double t = kStepS; t < 25; t += kStepS) {
    const double way_m = drive.way_m(t), speed_m_s = (drive.way_m(t + 1e-4) - drive.way_m(t - 1e-4)) / 2e-4;
    EXPECT_LE(speed_m_s, limit_m_s(way_m) + 0.4) << "at " << way_m << " m";
    EXPECT_LE(std::abs(speed_m_s - last_m_s), kAccelerate * kStepS + 0.01) << "at " << way_m << " m";
    last_m_s = speed_m_s;
    fastest_m_s = std::max(fastest_m_s, speed_m_s);
  }
  EXPECT_NEAR(fastest_m_s, 15, 0.01);
  EXPECT_NEAR(last_m_s, 15, 0.01) << "goes on after its end";
}

}  // namespace
}  // namespace coslam::sim::vehicle_test
