// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/ros/ros1.h"

#include <gmock/gmock.h>

#include "common/ros/messages.h"
#include "tests/common/recording/ros1_octets.h"

namespace coslam::ros::ros1_test {
namespace {

using Octets = std::vector<std::uint8_t>;

TEST(Ros1, AHeaderBeginsWithItsNumber) {
  const Octets octets{9, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0, 'm', 'a', 'p'};
  const auto header = from_ros1<Header>(octets);
  ASSERT_TRUE(header);
  EXPECT_EQ(header->stamp.sec, 1);
  EXPECT_EQ(header->stamp.nanosec, 2U);
  EXPECT_EQ(header->frame_id, "map");
}

TEST(Ros1, NothingIsAligned) {
  const Octets octets{1, 0, 0, 0, 'a', 5, 0, 0, 0, 7, 2, 0, 0, 0};  // of a point's field
  const auto field = from_ros1<PointField>(octets);
  ASSERT_TRUE(field);
  EXPECT_EQ(field->name, "a");
  EXPECT_EQ(field->offset, 5U);
  EXPECT_EQ(field->datatype, 7);
  EXPECT_EQ(field->count, 2U);
}

TEST(Ros1, CutOffAnywhereItIsNone) {
  PointCloud2 cloud;
  cloud.header.frame_id = "map";
  cloud.point_fields = {{"x", 0, PointField::kFloat32, 1}};
  cloud.data = {1, 2, 3};
  const std::string whole = recording::test::to_ros1(cloud);
  const auto octets = [&](std::size_t size) {
    return std::span(reinterpret_cast<const std::uint8_t*>(whole.data()), size);
  };
  for (std::size_t size = 0; size < whole.size(); ++size) EXPECT_FALSE(from_ros1<PointCloud2>(octets(size))) << size;
  const auto read = from_ros1<PointCloud2>(octets(whole.size()));
  ASSERT_TRUE(read);
  EXPECT_THAT(read->data, testing::ElementsAre(1, 2, 3));
  EXPECT_EQ(read->point_fields.at(0).name, "x");
}

TEST(Ros1, CountsThatLieTakeNoMemory) {
  Octets octets{0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 0xff, 0xff, 0xff, 0xff};
  EXPECT_FALSE(from_ros1<Header>(octets));
  octets = {0xff, 0xff, 0xff, 0xff, 1};
  Ros1Reader doubles(octets), structs(octets);
  std::vector<double> numbers;
  doubles.get(numbers);
  EXPECT_FALSE(doubles.ok());
  std::vector<PointField> fields;
  structs.get(fields);
  EXPECT_FALSE(structs.ok());
  EXPECT_LE(fields.size(), 1U);
}

}  // namespace
}  // namespace coslam::ros::ros1_test
