// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/publish/names.h"

#include <gtest/gtest.h>

namespace coslam::names_test {
namespace {

TEST(RosNames, KeepsWhatIsGoodAndReplacesTheRest) {
  RosNames names;
  EXPECT_EQ(names.ros_name("cam0"), "cam0");
  EXPECT_EQ(names.ros_name("drone-1.left"), "drone_1_left");
  EXPECT_EQ(names.ros_name("7up"), "agent_7up");
}

TEST(RosNames, NoTwoAgentsShareOne) {
  RosNames names;
  EXPECT_EQ(names.ros_name("a-b"), "a_b");
  EXPECT_EQ(names.ros_name("a.b"), "a_b_2");
  EXPECT_EQ(names.ros_name("a_b"), "a_b_3");
  EXPECT_EQ(names.ros_name("a-b"), "a_b") << "and it keeps the one it has";
}

TEST(Frames, MapsThatHaveNotMetHaveRootsOfTheirOwn) {
  EXPECT_EQ(frame_of(MapId(3), MapId(3)), "map");
  EXPECT_EQ(frame_of(MapId(4), MapId(3)), "map_4");
  EXPECT_EQ(odom_frame("cam0"), "cam0/odom");
  EXPECT_EQ(base_frame("cam0"), "cam0/base_link");
  EXPECT_EQ(camera_frame("cam0"), "cam0/camera_optical_frame");
}

}  // namespace
}  // namespace coslam::names_test
