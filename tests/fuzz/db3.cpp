// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// A database of rosbag2 as a source. SQLite itself is as Debian builds it, without the sanitizers.
#include <unistd.h>

#include <fstream>
#include <iterator>
#include <string>

#include "agent/capture/source.h"
#include "common/ros/convert.h"
#include "common/ros/sensor_messages.h"
#include "tests/common/recording/db3_file.h"
#include "tests/common/recording/ros1_octets.h"
#include "tests/fuzz/fuzzer.h"

namespace coslam {
namespace {

// In memory, with a name: SQLite follows links, and one to a file without a name leads nowhere.
std::filesystem::path place() { return "/dev/shm/coslam-fuzz-" + std::to_string(getpid()) + ".db3"; }

std::string database() {
  std::filesystem::remove(place());
  {
    recording::test::Db3File file(place());
    const auto topic = file.add_topic("/image", "sensor_msgs/msg/Image");
    ros::Image image;
    image.width = 3;
    image.height = 2;
    image.encoding = "mono8";
    image.step = 4;
    image.data.assign(8, 100);
    for (int i = 1; i <= 3; ++i) {
      image.header = ros::header_of(to_ns(i), "left");
      file.add(topic, to_ns(i), recording::test::to_cdr_text(image));
    }
  }
  std::ifstream stream(place(), std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

struct Removed {
  ~Removed() { std::filesystem::remove(place()); }
};

}  // namespace

void fuzz::try_octets(Octets octets) {
  const Removed removed;
  std::ofstream(place(), std::ios::binary) << text_of(octets);
  const auto source = open_source("bag:" + place().string(), {});
  while (source->peek_ns()) source->next();
}

void fuzz::write_seeds(const WriteSeed& write) {
  const Removed removed;
  const std::string whole = database();
  write("database", whole);
  write("cut_off", std::string_view(whole).substr(0, whole.size() - 600));
}

}  // namespace coslam
