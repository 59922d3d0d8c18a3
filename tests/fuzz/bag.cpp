// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// A bag of ROS 1 as a source, compressed as a whole or not: all of its images are read, or it is refused with a
// sentence.
#include <string>

#include "agent/capture/source.h"
#include "common/compression/compression.h"
#include "common/ros/convert.h"
#include "common/ros/sensor_messages.h"
#include "tests/common/recording/bag_file.h"
#include "tests/common/recording/ros1_octets.h"
#include "tests/fuzz/fuzzer.h"

namespace coslam {
namespace {

recording::test::BagFile bag(const std::string& compression) {
  recording::test::BagFile file(compression, 2);
  ros::Image image;
  image.width = 3;
  image.height = 2;
  image.encoding = "mono8";
  image.step = 4;
  image.data.assign(8, 100);
  for (int i = 1; i <= 3; ++i) {
    image.header = ros::header_of(to_ns(i), "left");
    file.add("/image", "sensor_msgs/Image", to_ns(i), recording::test::to_ros1(image));
    file.add("/words", "std_msgs/String", to_ns(i), "octets");
  }
  return file;
}

}  // namespace

void fuzz::try_octets(Octets octets) {
  const auto source = open_source("bag:" + file_of(text_of(octets)).string(), {});
  while (source->peek_ns()) source->next();
}

void fuzz::write_seeds(const WriteSeed& write) {
  for (const char* compression : {"none", "bz2", "lz4"}) write(compression, bag(compression).closed());
  write("unclosed", bag("none").unclosed());
  write("zstd", zstd_compressed(bag("none").closed()));
}

}  // namespace coslam
