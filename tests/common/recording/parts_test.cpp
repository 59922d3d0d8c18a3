// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <filesystem>

#include "common/base/error.h"
#include "common/base/log.h"
#include "common/mcap/writer.h"
#include "common/recording/recording.h"
#include "tests/common/recording/played.h"
#include "tests/support/temp_folder.h"

namespace coslam::recording::parts_test {
namespace {

using coslam::test::error_of;
using coslam::test::TempFolder;
using test::numbers;
using test::played;
using ::testing::AllOf;
using ::testing::HasSubstr;

// A folder without metadata: its files are the parts of one recording.
class Parts : public ::testing::Test {
 protected:
  // Messages "i" in the topic at i ms, from..to - 1.
  void write(const std::string& name, const std::string& topic, int from, int to) const {
    std::string octets;
    mcap::Writer writer([&](std::string_view more) { octets += more; },
                        {.compression = mcap::Compression::kNone, .chunk_bytes = 300});
    const auto channel = writer.add_channel(topic, "cdr", writer.add_schema("std_msgs/msg/String", "ros2msg", ""));
    for (int i = from; i < to; ++i) writer.write(channel, TimeNs{i} * 1'000'000, std::string_view(std::to_string(i)));
    writer.close();
    folder_.write(name, octets);
  }

  const TempFolder folder_;
  const LogPause quiet_;
};

TEST_F(Parts, ATopicMayBeInSomeOfThemAlone) {
  write("0.mcap", "/a", 10, 20);
  write("1.mcap", "/b", 15, 25);
  write("2.mcap", "/a", 20, 30);
  const auto recording = open(folder_.path());
  EXPECT_EQ(recording->topics().size(), 2U) << "each once";
  EXPECT_EQ(played(*recording, "/a"), numbers(10, 30));
  EXPECT_EQ(played(*recording, "/b"), numbers(15, 25));
}

TEST_F(Parts, TheirOrderIsThatOfTheirTimesNotOfTheirNames) {
  write("a.mcap", "/a", 40, 50);
  write("b.mcap", "/a", 10, 20);
  write("c.mcap", "/a", 15, 30);
  const auto recording = open(folder_.path());
  EXPECT_EQ(recording->first_ns(), 10'000'000);
  recording->play(0);
  TimeNs last_ns = 0;
  int count = 0;
  while (const auto message = recording->next()) {
    EXPECT_GE(message->noted_ns, last_ns);
    last_ns = message->noted_ns;
    ++count;
  }
  EXPECT_EQ(count, 35);
  EXPECT_FALSE(recording->next()) << "the end stays the end";
}

TEST_F(Parts, AnEmptyOneHasNoTime) {
  write("0.mcap", "/a", 0, 0);
  write("1.mcap", "/a", 30, 33);
  const auto recording = open(folder_.path());
  EXPECT_EQ(recording->first_ns(), 30'000'000);
  EXPECT_EQ(played(*recording, "/a"), numbers(30, 33));
  std::filesystem::remove(folder_ / "1.mcap");
  EXPECT_EQ(open(folder_.path())->first_ns(), 0) << "there is no message at all";
}

TEST_F(Parts, WhatIsPlayedAgainBeginsAnew) {
  write("0.mcap", "/a", 0, 10);
  write("1.mcap", "/a", 10, 20);
  const auto recording = open(folder_.path());
  recording->play(0);
  for (int i = 0; i < 12; ++i) EXPECT_TRUE(recording->next());
  EXPECT_EQ(played(*recording, "/a"), numbers(0, 20));
}

TEST_F(Parts, OneThatIsGoneWhenItsTimeComesIsLeftOut) {
  write("0.mcap", "/a", 0, 10);
  write("1.mcap", "/a", 10, 20);
  write("2.mcap", "/a", 20, 30);
  const auto recording = open(folder_.path());
  std::filesystem::remove(folder_ / "1.mcap");
  auto expected = numbers(0, 10);
  std::ranges::copy(numbers(20, 30), std::back_inserter(expected));
  EXPECT_EQ(played(*recording, "/a"), expected);
}

TEST_F(Parts, WhereNoneCanBeReadEachReasonIsTold) {
  folder_.write("0.mcap", "text");
  folder_.write("1.mcap", "more text");
  EXPECT_THAT(error_of<UserError>([&] { open(folder_.path()); }),
              AllOf(HasSubstr("0.mcap: is no MCAP file"), HasSubstr("; "), HasSubstr("1.mcap: is no MCAP file")));
  std::filesystem::remove(folder_ / "1.mcap");
  const std::string alone = error_of<UserError>([&] { open(folder_.path()); });
  EXPECT_THAT(alone, HasSubstr("0.mcap: is no MCAP file"));
}

TEST_F(Parts, FilesOfARecorderBesideItsDatabaseMakeNoFolderOfSomethingElse) {
  write("0.mcap", "/a", 0, 10);
  folder_.write("1.db3-wal", "");
  folder_.write("1.db3-shm", "");
  EXPECT_TRUE(is_recording(folder_.path()));
  std::filesystem::create_directory(folder_ / "more");
  EXPECT_FALSE(is_recording(folder_.path()));
}

TEST_F(Parts, MetadataWithoutTheWordsOfRosbag2IsNone) {
  write("0.mcap", "/a", 0, 10);
  folder_.write("metadata.yaml", "name: walk\n");
  EXPECT_FALSE(is_recording(folder_.path())) << "there is something else";
  EXPECT_EQ(played(*open(folder_.path()), "/a"), numbers(0, 10));
  folder_.write("metadata.yaml", "rosbag2_bagfile_information: {relative_file_paths: 0.mcap}\n");
  EXPECT_THAT(error_of<UserError>([&] { open(folder_.path()); }), HasSubstr("metadata.yaml:1"));
}

}  // namespace
}  // namespace coslam::recording::parts_test
