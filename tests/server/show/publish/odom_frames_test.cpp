// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/publish/odom_frames.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/ros/convert.h"

namespace coslam::odom_frames_test {
namespace {

// A walk along a curve, in a map.
Rigid3 cam_from_map(int i) {
  const Eigen::AngleAxisd turned(0.05 * i, Eigen::Vector3d(0.1, 1, 0.2).normalized());
  return {Eigen::Quaterniond(turned), {0.1 * i, 0.3 * std::sin(0.2 * i), 0.02 * i * i}};
}

// By where the camera was at 10 and is at 20.
Rigid3 moved(const Rigid3& at_10, const Rigid3& at_20) { return at_20 * at_10.inverse(); }

struct Walk {
  OdomFrames odom;
  Rigid3 map_from_old = Rigid3();  // what corrected the map since
  std::vector<Rigid3> cam_from_odom;

  void go(int from, int to) {
    for (int i = from; i < to; ++i) {
      const auto known = [&](TimeNs t_ns) { return std::optional(now(static_cast<int>(t_ns))); };
      cam_from_odom.push_back(odom.follow("a", i, now(i), known));
    }
  }
  // at_20: the pose that was told of then.
  void expect_as_in_map(std::size_t at_20) const {
    const Rigid3 in_map = moved(cam_from_map(10), cam_from_map(20));
    EXPECT_LT(local(moved(cam_from_odom.at(10), cam_from_odom.at(at_20)), in_map).norm(), 1e-12);
  }
  Rigid3 now(int i) const { return cam_from_map(i) * map_from_old.inverse(); }
};

TEST(OdomFrames, BeginsWhereTheBodyIs) {
  Walk walk;
  walk.go(7, 8);
  EXPECT_LT(local(walk.cam_from_odom[0].inverse() * ros::base_from_optical().inverse(), Rigid3()).norm(), 1e-12);
}

TEST(OdomFrames, MovesAsTheCameraDoesInItsMap) {
  Walk walk;
  walk.go(0, 30);
  walk.expect_as_in_map(20);
}

TEST(OdomFrames, ACorrectionDoesNotMoveIt) {
  Walk walk;
  walk.go(0, 15);
  walk.map_from_old = {Eigen::Quaterniond(Eigen::AngleAxisd(1, Eigen::Vector3d::UnitZ())), {5, -3, 2}};
  walk.go(15, 30);
  walk.expect_as_in_map(20);
}

TEST(OdomFrames, AfterALossItIsWhereTheMapSays) {
  Walk walk;
  walk.go(0, 11);
  walk.go(20, 21);
  walk.expect_as_in_map(11);
}

TEST(OdomFrames, StandsStillWhereNothingIsKnown) {
  OdomFrames odom;
  const auto unknown = [](TimeNs) { return std::optional<Rigid3>(); };
  odom.follow("a", 0, cam_from_map(0), unknown);
  const Rigid3 before = odom.follow("a", 1, cam_from_map(1), [](TimeNs) { return cam_from_map(0); });
  const Rigid3 after = odom.follow("a", 2, Rigid3(), unknown);
  EXPECT_EQ(local(before, after).norm(), 0);
  const Rigid3 next = odom.follow("a", 3, cam_from_map(9), [](TimeNs) { return cam_from_map(8); });
  EXPECT_LT(local(moved(after, next), moved(cam_from_map(8), cam_from_map(9))).norm(), 1e-12);
}

}  // namespace
}  // namespace coslam::odom_frames_test
