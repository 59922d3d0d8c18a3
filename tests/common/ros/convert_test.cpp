// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/ros/convert.h"

#include <gtest/gtest.h>

#include <limits>

namespace coslam::ros::convert_test {
namespace {

TEST(Convert, TimesKeepTheirNanoseconds) {
  EXPECT_EQ(time_of(1'700'000'000'123'456'789).sec, 1'700'000'000);
  EXPECT_EQ(time_of(1'700'000'000'123'456'789).nanosec, 123'456'789U);
  for (const TimeNs t : {TimeNs(0), TimeNs(-1), TimeNs(-2'500'000'000), TimeNs(999'999'999)}) {
    EXPECT_EQ(ns_of(time_of(t)), t);
    EXPECT_LT(time_of(t).nanosec, 1'000'000'000U);
  }
  EXPECT_EQ(time_of(std::numeric_limits<TimeNs>::max()).sec, std::numeric_limits<std::int32_t>::max());
}

TEST(Convert, APoseSaysWhereTheChildIs) {
  const Rigid3 world_from_cam(so3_exp({0, 0, 0.5}), {1, 2, 3});
  const Pose pose = pose_of(world_from_cam);
  EXPECT_EQ(pose.position.y, 2);
  EXPECT_NEAR(pose.orientation.z, std::sin(0.25), 1e-12);
  EXPECT_NEAR(pose.orientation.w, std::cos(0.25), 1e-12);
  EXPECT_EQ(transform_of(world_from_cam).translation.z, 3);
}

// The same small change of a pose, said in both ways.
TEST(Convert, TheCovarianceIsThatOfTheCameraInTheWorld) {
  const Rigid3 cam_from_world(so3_exp({0.4, -0.9, 1.3}), {0.7, -2, 0.3});
  const Rigid3 before = cam_from_world.inverse();
  Vector6d delta;
  delta << 1e-5, -2e-5, 3e-5, 4e-5, 5e-5, -6e-5;
  const Rigid3 after = retract(cam_from_world, delta).inverse();
  Vector6d moved;
  moved << after.translation - before.translation, so3_log(after.rotation * before.rotation.conjugate());
  const Covariance36 rows = world_covariance(cam_from_world, delta * delta.transpose());
  const Matrix6d expected = moved * moved.transpose();
  for (int r = 0; r < 6; ++r) {
    for (int c = 0; c < 6; ++c) EXPECT_NEAR(rows[static_cast<std::size_t>(6 * r + c)], expected(r, c), 1e-12);
  }
}

}  // namespace
}  // namespace coslam::ros::convert_test
