// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/ros/views.h"

#include <gtest/gtest.h>

#include <cstring>

#include "common/ros/convert.h"

namespace coslam::ros::views_test {
namespace {

template <class T>
T value_at(const PointCloud2& cloud, std::size_t point, const std::string& field) {
  for (const PointField& f : cloud.point_fields) {
    if (f.name != field) continue;
    T value;
    std::memcpy(&value, cloud.data.data() + point * cloud.point_step + f.offset, sizeof(T));
    return value;
  }
  ADD_FAILURE() << "no field " << field;
  return {};
}

TEST(Views, AStaticCloudSaysWhereItsFieldsAre) {
  const std::vector<StaticPoint> points = {{{1, 2, 3}, 0.5F, PointId(7), MapId(1), false, 9},
                                           {{4, 5, 6}, 0.25F, PointId(8), MapId(2), true, 65535}};
  const PointCloud2 cloud = static_cloud(header_of(10, "map"), points);
  EXPECT_EQ(cloud.header.frame_id, "map");
  EXPECT_EQ(cloud.width, 2U);
  EXPECT_EQ(cloud.height, 1U);
  EXPECT_EQ(cloud.data.size(), 2 * cloud.point_step);
  EXPECT_EQ(value_at<float>(cloud, 0, "z"), 3);
  EXPECT_EQ(value_at<float>(cloud, 1, "sigma"), 0.25F);
  EXPECT_EQ(value_at<std::uint32_t>(cloud, 1, "id"), 8U);
  EXPECT_EQ(value_at<std::uint32_t>(cloud, 0, "map"), 1U);
  EXPECT_EQ(value_at<std::uint8_t>(cloud, 1, "state"), 1);
  EXPECT_EQ(value_at<std::uint16_t>(cloud, 0, "views"), 9);
  EXPECT_EQ(value_at<std::uint16_t>(cloud, 1, "views"), 65535);
  for (const PointField& f : cloud.point_fields) {
    const std::uint32_t bytes = f.datatype == PointField::kUint8 ? 1 : f.datatype == PointField::kUint16 ? 2 : 4;
    EXPECT_EQ(f.offset % bytes, 0U) << f.name;
    EXPECT_EQ(cloud.point_step % 4, 0U);
  }
}

TEST(Views, AMovingCloudNamesTheObjects) {
  const std::vector<MovingPoint> points = {{{1, 2, 3}, 0.5F, PointId(7), ObjectId(3)}};
  const PointCloud2 cloud = moving_cloud(header_of(10, "map"), points);
  EXPECT_EQ(value_at<std::uint32_t>(cloud, 0, "object"), 3U);
  EXPECT_EQ(value_at<float>(cloud, 0, "y"), 2);
  EXPECT_TRUE(moving_cloud(header_of(10, "map"), {}).data.empty());
}

TEST(Views, AnObjectIsABoxAndAnArrowToWhereItIsInASecond) {
  const std::vector<MovingObject> objects = {{ObjectId(3), {1, 0, 0}, {0, 2, 0}, {0.5, 0, 1.7}}};
  const MarkerArray array = object_markers(header_of(0, "map"), objects);
  ASSERT_EQ(array.markers.size(), 2U);
  const Marker &box = array.markers[0], &arrow = array.markers[1];
  EXPECT_EQ(box.type, Marker::kCube);
  EXPECT_EQ(box.id, 3);
  EXPECT_EQ(box.scale.z, 1.7);
  EXPECT_GT(box.scale.y, 0) << "viewers complain about flat boxes";
  EXPECT_EQ(arrow.type, Marker::kArrow);
  EXPECT_EQ(arrow.points.at(1).x, 1);
  EXPECT_EQ(arrow.points.at(1).y, 2);
  EXPECT_GT(arrow.lifetime.nanosec, 0U);

  const Detection3DArray detections = object_detections(header_of(0, "map"), objects);
  ASSERT_EQ(detections.detections.size(), 1U);
  EXPECT_EQ(detections.detections[0].id, "3");
  EXPECT_EQ(detections.detections[0].bbox.size.x, 0.5);
}

}  // namespace
}  // namespace coslam::ros::views_test
