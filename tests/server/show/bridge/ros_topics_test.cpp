// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/bridge/ros_topics.h"

#include <gtest/gtest.h>

#include "common/ros/cdr.h"
#include "common/ros/std_messages.h"

namespace coslam::ros_topics_test {
namespace {

TEST(RosTopics, HaveTheNamesThatNodesGiveThem) {
  const auto points = ros_topic("/coslam/map/points", "sensor_msgs/msg/PointCloud2");
  ASSERT_TRUE(points);
  EXPECT_EQ(points->name, "rt/coslam/map/points");
  EXPECT_EQ(points->type, "sensor_msgs::msg::dds_::PointCloud2_");
  EXPECT_TRUE(points->reliable && points->late_joiners);
  EXPECT_EQ(points->depth, 1);
}

TEST(RosTopics, AreDeliveredAsNodesExpect) {
  const auto odom = ros_topic("/coslam/cam0/odom", "nav_msgs/msg/Odometry");
  EXPECT_TRUE(odom->reliable) << "it serves best-effort readers too";
  EXPECT_FALSE(odom->late_joiners);
  EXPECT_EQ(odom->depth, 5);
  EXPECT_EQ(ros_topic("/tf", "tf2_msgs/msg/TFMessage")->depth, 100);
  EXPECT_TRUE(ros_topic("/coslam/cam0/path", "nav_msgs/msg/Path")->late_joiners);
  EXPECT_FALSE(ros_topic("/fmu/in/vehicle_visual_odometry", "px4_msgs/msg/VehicleOdometry")->reliable);
}

TEST(RosTopics, JsonIsAString) {
  EXPECT_EQ(ros_topic("/coslam/state", kJsonType)->type, "std_msgs::msg::dds_::String_");
  const auto read = ros::from_cdr<ros::String>(ros_octets({"/coslam/state", kJsonType, 0, {'{', '}'}}));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->data, "{}");
}

TEST(RosTopics, WhatIsNotKnownIsNotHandedOn) {
  EXPECT_FALSE(ros_topic("/a", "std_msgs/msg/Int8"));
  EXPECT_FALSE(ros_topic("a", "std_msgs/msg/String"));
}

}  // namespace
}  // namespace coslam::ros_topics_test
