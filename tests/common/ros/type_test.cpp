// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/ros/type.h"

#include <gtest/gtest.h>

#include "common/ros/messages.h"

namespace coslam::ros::type_test {
namespace {

TEST(Type, HasTheNamesOfToolsAndOfNodes) {
  const TypeText& text = type_text<PointCloud2>();
  EXPECT_EQ(text.name, "sensor_msgs/msg/PointCloud2");
  EXPECT_EQ(text.dds_name, "sensor_msgs::msg::dds_::PointCloud2_");
  EXPECT_EQ(find_type("sensor_msgs/msg/PointCloud2"), &text);
  EXPECT_EQ(find_type("sensor_msgs/PointCloud2"), nullptr);
  EXPECT_EQ(find_type("px4_msgs/msg/VehicleOdometry")->dds_name, "px4_msgs::msg::dds_::VehicleOdometry_");
}

TEST(Type, NamesOfDdsAreThoseOfTools) {
  EXPECT_EQ(dds_topic_of("/left/image_raw"), "rt/left/image_raw");
  EXPECT_EQ(topic_of_dds("rt/left/image_raw"), "/left/image_raw");
  EXPECT_EQ(topic_of_dds("rq/left/set_parametersRequest"), std::nullopt);
  EXPECT_EQ(topic_of_dds("rtx"), std::nullopt);
  EXPECT_EQ(type_of_dds("sensor_msgs::msg::dds_::Image_"), "sensor_msgs/msg/Image");
  EXPECT_EQ(type_of_dds("a::b::srv::dds_::C_Request_"), "a/b/srv/C_Request");
  EXPECT_EQ(type_of_dds("ParticipantEntitiesInfo"), "ParticipantEntitiesInfo");
}

TEST(Type, TheDefinitionHasAllPartsOnce) {
  const std::string line(80, '=');
  EXPECT_EQ(type_text<PoseStamped>().schema,
            "std_msgs/Header header\ngeometry_msgs/Pose pose\n" + line +
                "\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n" + line +
                "\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n" + line +
                "\nMSG: geometry_msgs/Pose\ngeometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n" +
                line + "\nMSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n" + line +
                "\nMSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n");
}

TEST(Type, TheDefinitionSaysWhatIsAListAndHowLong) {
  const std::string cloud = type_text<PointCloud2>().schema;
  EXPECT_NE(cloud.find("sensor_msgs/PointField[] fields\nbool is_bigendian\n"), std::string::npos);
  EXPECT_NE(cloud.find("uint8[] data\n"), std::string::npos);
  EXPECT_NE(type_text<CameraInfo>().schema.find("float64[] d\nfloat64[9] k\n"), std::string::npos);
  EXPECT_NE(type_text<VehicleOdometry>().schema.find("float32[4] q\n"), std::string::npos);
  EXPECT_NE(type_text<VehicleOdometry>().schema.find("int8 quality\n"), std::string::npos);
}

}  // namespace
}  // namespace coslam::ros::type_test
