// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/ros/cdr.h"

#include <gtest/gtest.h>

#include <limits>

#include "common/ros/messages.h"

namespace coslam::ros::cdr_test {
namespace {

using Octets = std::vector<std::uint8_t>;

TEST(Cdr, AHeaderIsTheseOctets) {
  const Header header{{1, 2}, "map"};
  EXPECT_EQ(to_cdr(header), (Octets{0, 1, 0, 0,                    // little endian
                                    1, 0, 0, 0, 2,   0,   0,   0,  // time
                                    4, 0, 0, 0, 'm', 'a', 'p', 0}));
}

TEST(Cdr, NumbersStandAtMultiplesOfTheirSize) {
  PoseStamped pose;
  pose.header.frame_id = "ab";  // 8 + 4 + 3 octets: x at 16
  pose.pose.position.x = 1.0;
  const Octets octets = to_cdr(pose);
  ASSERT_EQ(octets.size(), 4U + 16 + 7 * 8);
  EXPECT_EQ(octets[4 + 15], 0) << "padding";
  EXPECT_EQ(octets[4 + 16 + 7], 0x3f) << "the last octet of 1.0";
  pose.header.frame_id = "abc";  // ends at 16: no padding
  EXPECT_EQ(to_cdr(pose).size(), octets.size());
  pose.header.frame_id = "abcd";
  EXPECT_EQ(to_cdr(pose).size(), octets.size() + 8);
}

TEST(Cdr, EmptyListsAlignNothingThatFollows) {
  PointCloud2 cloud;  // its last field, a bool, comes right after the count of its octets
  const std::size_t empty = to_cdr(cloud).size();
  cloud.data = {7, 8, 9};
  const Octets octets = to_cdr(cloud);
  EXPECT_EQ(octets.size(), empty + 3);
  EXPECT_EQ((Octets{octets.end() - 8, octets.end()}), (Octets{3, 0, 0, 0, 7, 8, 9, 1}));
  CameraInfo info;  // an empty list of doubles before an array of doubles
  info.k[0] = 1.0;
  const auto read = from_cdr<CameraInfo>(to_cdr(info));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->k[0], 1.0);
}

TEST(Cdr, AViewOfAnImageLeavesItsOctetsWhereTheyLie) {
  const Octets octets = to_cdr(Image{{{1, 2}, "camera"}, 2, 3, "mono8", 0, 3, {1, 2, 3, 4, 5, 6}});
  const auto view = from_cdr<ImageView>(octets);
  ASSERT_TRUE(view);
  EXPECT_EQ(view->encoding, "mono8");
  EXPECT_EQ((Octets{view->data.begin(), view->data.end()}), (Octets{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(view->data.data(), octets.data() + octets.size() - 6);
  EXPECT_FALSE(from_cdr<ImageView>(std::span(octets).first(octets.size() - 1)));
}

TEST(Cdr, TheOdometryOfPx4Has118Octets) {
  VehicleOdometry odometry;
  odometry.timestamp = 0x0102030405060708;
  odometry.pose_frame = VehicleOdometry::kFrd;
  odometry.position = {1, 2, 3};
  odometry.q = {1, 0, 0, 0};
  odometry.velocity_frame = VehicleOdometry::kNed;
  odometry.reset_counter = 5;
  odometry.quality = -1;
  const Octets octets = to_cdr(odometry);
  ASSERT_EQ(octets.size(), 118U);
  const auto at = [&](std::size_t place) { return octets[4 + place]; };
  EXPECT_EQ(at(0), 8);
  EXPECT_EQ(at(7), 1);
  EXPECT_EQ(at(16), 2) << "pose_frame";
  EXPECT_EQ(at(20 + 3), 0x3f) << "position[0], after three octets of padding";
  EXPECT_EQ(at(32 + 3), 0x3f) << "q[0] is w";
  EXPECT_EQ(at(48), 1) << "velocity_frame";
  EXPECT_EQ(at(112), 5) << "reset_counter";
  EXPECT_EQ(at(113), 0xff) << "quality";
}

Image image_value() {
  Image image;
  image.header = {{5, 6}, "left/camera_optical_frame"};
  image.height = 2;
  image.width = 3;
  image.encoding = "mono8";
  image.step = 3;
  image.data = {1, 2, 3, 4, 5, 6};
  return image;
}

TEST(Cdr, ReadsWhatItWrote) {
  const Image image = image_value();
  const auto read = from_cdr<Image>(to_cdr(image));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->header.frame_id, image.header.frame_id);
  EXPECT_EQ(read->data, image.data);
  EXPECT_EQ(to_cdr(*read), to_cdr(image));

  Path path;
  path.poses.resize(3);
  path.poses[2].header.frame_id = "map";
  path.poses[2].pose.position.z = -0.5;
  EXPECT_EQ(to_cdr(*from_cdr<Path>(to_cdr(path))), to_cdr(path));
  Marker marker;
  marker.texture.data = {9};
  marker.mesh_file.filename = "a";
  marker.uv_coordinates.resize(2);
  EXPECT_EQ(to_cdr(*from_cdr<Marker>(to_cdr(marker))), to_cdr(marker));
}

TEST(Cdr, WhatIsCutOffIsNoMessage) {
  Octets octets = to_cdr(image_value());
  for (std::size_t size = 0; size < octets.size(); ++size) {
    EXPECT_FALSE(from_cdr<Image>(std::span(octets).first(size))) << size;
  }
  octets.resize(octets.size() + 3);  // DDS pads samples
  EXPECT_TRUE(from_cdr<Image>(octets));
}

TEST(Cdr, WhatLiesIsNoMessage) {
  const Octets octets = to_cdr(image_value());
  const auto with = [&](std::size_t place, std::uint8_t value) {
    Octets changed = octets;
    changed[place] = value;
    return from_cdr<Image>(changed).has_value();
  };
  EXPECT_FALSE(with(1, 0)) << "big endian";
  EXPECT_FALSE(with(1, 7)) << "another form of CDR";
  EXPECT_FALSE(with(4 + 8 + 3, 0x7f)) << "a text of 2 GB";
  EXPECT_FALSE(with(4 + 8 + 4 + 25, 'x')) << "a text without end";
  Path path;
  Octets many = to_cdr(path);
  many.back() = 0x7f;
  EXPECT_FALSE(from_cdr<Path>(many)) << "more poses than there are octets";
}

TEST(Cdr, TakesTextsWithoutTheirZero) {
  const Octets none = {0, 1, 0, 0, 0, 0, 0, 0};
  const auto read = from_cdr<String>(none);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->data, "");
}

}  // namespace
}  // namespace coslam::ros::cdr_test
