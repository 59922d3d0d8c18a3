// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/recording/recording.h"

#include <gmock/gmock.h>

#include <cstdlib>

#include "common/base/error.h"
#include "common/compression/compression.h"
#include "tests/common/mcap/mcap_file.h"
#include "tests/common/recording/bag_file.h"
#include "tests/common/recording/db3_file.h"
#include "tests/common/recording/played.h"
#include "tests/support/temp_folder.h"

namespace coslam::recording::recording_test {
namespace {

namespace fs = std::filesystem;
using coslam::test::TempFolder;
using test::numbers;
using test::played;
using ::testing::EndsWith;
using ::testing::HasSubstr;

std::string error_of_opening(const fs::path& path) {
  return coslam::test::error_of<UserError>([&] { open(path); });
}

class Recordings : public ::testing::Test {
 protected:
  // Messages "i" in /even and /odd at i ms, from..to - 1.
  static std::string mcap(int from, int to) {
    std::string octets;
    mcap::Writer writer([&](std::string_view more) { octets += more; },
                        {.compression = mcap::Compression::kNone, .chunk_bytes = 300});
    const auto schema = writer.add_schema("std_msgs/msg/String", "ros2msg", "string data\n");
    const auto even = writer.add_channel("/even", "cdr", schema), odd = writer.add_channel("/odd", "cdr", schema);
    for (int i = from; i < to; ++i)
      writer.write(i % 2 == 0 ? even : odd, TimeNs{i} * 1'000'000, std::string_view(std::to_string(i)));
    writer.close();
    return octets;
  }
  std::string db3(int from, int to) {
    const fs::path file = folder_ / "made.db3";
    fs::remove(file);
    test::counted_db3(file, from, to);
    const std::string octets = mcap::test::octets_in(file);
    fs::remove(file);
    return octets;
  }
  static std::string bag(int from, int to) {
    test::BagFile bag;
    for (int i = from; i < to; ++i) {
      bag.add(i % 2 == 0 ? "/even" : "/odd", "std_msgs/String", TimeNs{i} * 1'000'000, std::to_string(i));
    }
    return bag.closed();
  }
  void write_metadata(const std::vector<std::string>& files, const std::string& more = "") {
    std::string text =
        "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: mcap\n" + more + "  relative_file_paths:\n";
    for (const std::string& file : files) text += "    - " + file + "\n";
    folder_.write("metadata.yaml", text);
  }

  TempFolder folder_;
};

TEST_F(Recordings, AFileIsToldByItsFirstOctetsAlone) {
  for (const std::string& octets : {mcap(0, 50), db3(0, 50), bag(0, 50)}) {
    for (const std::string& whole : {octets, zstd_compressed(octets)}) {
      const auto recording = open(folder_.write("named_wrongly.txt", whole));
      EXPECT_EQ(recording->warning(), "");
      EXPECT_EQ(recording->topics().size(), 2U);
      EXPECT_EQ(played(*recording, "/even"), numbers(0, 50, 2));
      EXPECT_EQ(played(*recording, "/odd"), numbers(1, 50, 2));
    }
  }
}

TEST_F(Recordings, ACompressedFileThatIsCutOffIsReadUntilThere) {
  const std::string octets = zstd_compressed(mcap(0, 50'000));
  const fs::path file = folder_.write("a.mcap.zstd", octets.substr(0, octets.size() / 2));
  const auto recording = open(file);
  EXPECT_THAT(recording->warning(), HasSubstr(file.string() + ": its compressed octets are cut off or damaged; "));
  const auto texts = played(*recording, "/even");
  EXPECT_EQ(texts, numbers(0, 2 * static_cast<int>(texts.size()), 2));
  EXPECT_GT(texts.size(), 1000U);
}

TEST_F(Recordings, NoTemporaryFileIsLeft) {
  const char* before = std::getenv("TMPDIR");
  const std::string kept = before == nullptr ? "" : before;
  setenv("TMPDIR", folder_.path().c_str(), 1);
  const auto recording = open(folder_.write("a.mcap.zstd", zstd_compressed(mcap(0, 50))));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), {}), 1) << "gone while it is read";
  EXPECT_EQ(played(*recording, "/odd"), numbers(1, 50, 2));
  setenv("TMPDIR", "/nowhere", 1);
  EXPECT_EQ(error_of_opening(folder_ / "a.mcap.zstd"), "no temporary file can be made in $TMPDIR, or /tmp without it");
  before == nullptr ? unsetenv("TMPDIR") : setenv("TMPDIR", kept.c_str(), 1);
}

TEST_F(Recordings, ASplitOneIsPlayedAsOne) {
  write_metadata({"a_0.mcap", "a_1.mcap", "a_2.mcap"});
  folder_.write("a_0.mcap", mcap(10, 31));
  folder_.write("a_1.mcap", mcap(31, 60));
  folder_.write("a_2.mcap", mcap(60, 61));
  const auto recording = open(folder_.path());
  EXPECT_EQ(recording->warning(), "");
  EXPECT_EQ(recording->topics().size(), 2U);
  EXPECT_EQ(recording->first_ns(), 10'000'000);
  EXPECT_EQ(played(*recording, "/odd"), numbers(11, 61, 2));
  EXPECT_EQ(played(*recording, "/even"), numbers(10, 61, 2)) << "once more from the start";
}

TEST_F(Recordings, PartsThatOverlapComeByTime) {
  mcap::WriterConfig config;
  for (const int part : {1, 0}) {
    std::string octets;
    mcap::Writer writer([&](std::string_view more) { octets += more; }, config);
    const auto channel = writer.add_channel("/a", "cdr", writer.add_schema("a", "ros2msg", ""));
    for (int i = part; i < 20; i += 2) writer.write(channel, i + 1, std::string_view(std::to_string(i)));
    writer.close();
    folder_.write("part_" + std::to_string(part) + ".mcap", octets);
  }
  const auto recording = open(folder_.path());
  EXPECT_EQ(played(*recording, "/a"), numbers(0, 20));
}

TEST_F(Recordings, PartsThatAreMissingAreSaidAndTheRestPlays) {
  write_metadata({"a_0.db3", "a_1.db3", "a_2.db3", "a_3.db3"});
  folder_.write("a_0.db3", db3(0, 10));
  folder_.write("a_2.db3", db3(20, 30));
  folder_.write("a_3.db3", "no database");
  const auto recording = open(folder_.path());
  EXPECT_THAT(recording->warning(), HasSubstr(folder_.path().string() + ": these of its files are missing: a_1.db3; "));
  EXPECT_THAT(recording->warning(), HasSubstr("a_3.db3: is no MCAP file"));
  auto expected = numbers(0, 10, 2);
  std::ranges::copy(numbers(20, 30, 2), std::back_inserter(expected));
  EXPECT_EQ(played(*recording, "/even"), expected);
  fs::remove(folder_ / "a_0.db3");
  fs::remove(folder_ / "a_2.db3");
  fs::remove(folder_ / "a_3.db3");
  EXPECT_THAT(error_of_opening(folder_.path()),
              EndsWith("none of the files that its metadata.yaml names are there: a_0.db3, a_1.db3, a_2.db3, a_3.db3"));
}

TEST_F(Recordings, FilesThatWereRenamedAreRead) {
  write_metadata({"rosbag2_0.db3"});
  folder_.write("walk_0.db3", db3(0, 10));
  const auto recording = open(folder_.path());
  EXPECT_THAT(recording->warning(), EndsWith("names are there: rosbag2_0.db3; those that are there are read"));
  EXPECT_EQ(played(*recording, "/even"), numbers(0, 10, 2));
}

TEST_F(Recordings, CompressedPartsAreFoundByEitherName) {
  write_metadata({"a_0.mcap.zstd", "a_1.mcap.zstd", "elsewhere/a_2.mcap"},
                 "  compression_format: zstd\n  compression_mode: FILE\n");
  folder_.write("a_0.mcap.zstd", zstd_compressed(mcap(0, 10)));
  folder_.write("a_1.mcap", mcap(10, 20));
  folder_.write("a_2.mcap.zstd", zstd_compressed(mcap(20, 30)));
  const auto recording = open(folder_.path());
  EXPECT_EQ(recording->warning(), "");
  EXPECT_EQ(played(*recording, "/odd"), numbers(1, 30, 2));
}

TEST_F(Recordings, AFolderWithoutMetadataIsTakenByItsFiles) {
  folder_.write("b.mcap", mcap(0, 10));
  folder_.write("b.mcap.zstd", zstd_compressed(mcap(0, 10)));
  folder_.write("a.mcap", mcap(10, 20));
  folder_.write("notes.txt", "of no use");
  const auto recording = open(folder_.path());
  EXPECT_EQ(played(*recording, "/odd"), numbers(1, 20, 2));
}

TEST_F(Recordings, APartThatIsDamagedFurtherOnEndsThere) {
  std::string damaged = mcap(0, 100);
  damaged[damaged.find("60", damaged.find("58"))] ^= 1;
  folder_.write("a_0.mcap", damaged);
  folder_.write("a_1.mcap", mcap(100, 110));
  const auto recording = open(folder_.path());
  const auto texts = played(*recording, "/even");
  EXPECT_EQ(texts.front(), "0");
  EXPECT_EQ(texts.back(), "108");
  EXPECT_LT(texts.size(), 55U);
}

TEST_F(Recordings, SaysWhatIsWrong) {
  EXPECT_EQ(error_of_opening("/nowhere.mcap"), "/nowhere.mcap: cannot be read: there is no such file");
  EXPECT_THAT(error_of_opening(folder_.write("a.mcap", "text")),
              EndsWith("is no MCAP file, no .db3 of rosbag2 and no bag of ROS 1"));
  EXPECT_THAT(error_of_opening(folder_.write("a.mcap.zstd", zstd_compressed("text"))), EndsWith("and no bag of ROS 1"));
  fs::create_directory(folder_ / "empty");
  EXPECT_THAT(error_of_opening(folder_ / "empty"), HasSubstr("holds neither the metadata.yaml of rosbag2 nor"));
  write_metadata({"a.mcap"}, "  compression_format: lz4\n");
  EXPECT_THAT(error_of_opening(folder_.path()), HasSubstr("is compressed with lz4, which is not read; only zstd is"));
  folder_.write("metadata.yaml", "rosbag2_bagfile_information: {}\n");
  EXPECT_THAT(error_of_opening(folder_.path()), HasSubstr("relative_file_paths"));
}

TEST_F(Recordings, WhatLooksLikeOne) {
  EXPECT_TRUE(is_recording(folder_.write("bags/a.mcap", mcap(0, 1))));
  EXPECT_TRUE(is_recording(folder_ / "bags"));
  EXPECT_TRUE(is_recording(folder_.write("bags/named_wrongly.txt", bag(0, 1))));
  EXPECT_FALSE(is_recording(folder_ / "bags")) << "there is something else";
  EXPECT_TRUE(is_recording(folder_.write("a.db3.zstd", zstd_compressed("anything"))));
  EXPECT_TRUE(is_recording(folder_.write("a.bag.zst", zstd_compressed("anything"))));
  EXPECT_FALSE(is_recording(folder_.write("a.tar.zst", zstd_compressed("anything"))));
  EXPECT_FALSE(is_recording(folder_.write("a.txt", "0 a.png\n")));
  EXPECT_FALSE(is_recording(folder_ / "none"));
  EXPECT_FALSE(is_recording(folder_.path()));
  write_metadata({"a_0.mcap"});
  EXPECT_TRUE(is_recording(folder_.path()));
  fs::create_directory(folder_ / "empty");
  EXPECT_FALSE(is_recording(folder_ / "empty"));
}

}  // namespace
}  // namespace coslam::recording::recording_test
