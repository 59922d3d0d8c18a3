// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/recording/bag_reader.h"

#include <gmock/gmock.h>

#include "common/base/error.h"
#include "tests/common/recording/bag_file.h"
#include "tests/common/recording/played.h"
#include "tests/support/temp_folder.h"

namespace coslam::recording::bag_reader_test {
namespace {

using coslam::test::TempFolder;
using test::BagFile;
using test::numbers;
using test::played;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Message i is "i" in /even or /odd, at i ms.
BagFile counted(int messages, const std::string& compression = "none") {
  BagFile bag(compression);
  for (int i = 0; i < messages; ++i) {
    const bool even = i % 2 == 0;
    bag.add(even ? "/even" : "/odd", even ? "std_msgs/String" : "a/B", TimeNs{i} * 1'000'000, std::to_string(i));
  }
  return bag;
}

class BagOf : public ::testing::TestWithParam<const char*> {
 protected:
  TempFolder folder_;
};

TEST_P(BagOf, ReadsWhatWasWritten) {
  BagReader bag(folder_.write("a.bag", counted(50, GetParam()).closed()), "a.bag");
  EXPECT_EQ(bag.warning(), "");
  EXPECT_THAT(bag.topics(), ElementsAre(Topic{"/even", "std_msgs/String", "ros1"}, Topic{"/odd", "a/B", "ros1"}));
  EXPECT_EQ(bag.first_ns(), 0);
  EXPECT_EQ(played(bag, "/even"), numbers(0, 50, 2));
  EXPECT_EQ(played(bag, "/odd"), numbers(1, 50, 2)) << "once more from the start";
}

TEST_P(BagOf, WithoutItsIndexItIsGoneThrough) {
  BagReader bag(folder_.write("a.bag", counted(50, GetParam()).unclosed()), "a.bag");
  EXPECT_THAT(bag.warning(), HasSubstr("a.bag: was not closed"));
  EXPECT_EQ(bag.topics().size(), 2U);
  EXPECT_EQ(played(bag, "/odd"), numbers(1, 50, 2));
}

TEST_P(BagOf, CutOffAnywhereItIsReadUntilThere) {
  const std::string whole = counted(40, GetParam()).closed();
  std::size_t least = 20;
  for (std::size_t size = whole.size() - 1; size > 150; size -= 37) {
    BagReader bag(folder_.write("a.bag", whole.substr(0, size)), "a.bag");
    EXPECT_NE(bag.warning(), "");
    const auto texts = played(bag, "/even");
    EXPECT_EQ(texts, numbers(0, 2 * static_cast<int>(texts.size()), 2));
    EXPECT_LE(texts.size(), least);
    least = texts.size();
  }
  EXPECT_EQ(least, 0U);
}

TEST_P(BagOf, AnOctetThatChangedBreaksNothing) {
  const std::string whole = counted(40, GetParam()).closed();
  for (std::size_t at = 0; at < whole.size(); at += 7) {
    std::string changed = whole;
    changed[at] = static_cast<char>(changed[at] ^ 0x41);
    const auto file = folder_.write("a.bag", changed);
    try {
      BagReader bag(file, "a.bag");
      played(bag, "/even");
    } catch (const UserError& e) {
      EXPECT_THAT(e.what(), HasSubstr("a.bag: "));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Bags, BagOf, ::testing::Values("none", "bz2", "lz4"));

TEST(BagReader, MessagesOfOneTopicComeByTimeWhateverTheirChunk) {
  const TempFolder folder;
  BagFile bag("none", 2);
  for (const int t : {5, 1, 4, 2, 6, 3, 0}) bag.add("/a", "a/A", t, std::to_string(t));
  BagReader reader(folder.write("a.bag", bag.closed()), "a.bag");
  EXPECT_EQ(played(reader, "/a"), numbers(0, 7));
}

TEST(BagReader, TwoWritersOfATopicAreOne) {
  const TempFolder folder;
  std::string octets(kBagMagic);
  octets += BagFile::record({{"op", "\x03"}, {"index_pos", std::string(8, '\0')}}, "");
  for (const std::uint32_t connection : {7U, 9U}) {
    octets += BagFile::record({{"op", "\x07"}, {"conn", BagFile::number(connection)}, {"topic", "/a"}},
                              BagFile::header({{"type", "a/A"}}));
  }
  for (const std::uint32_t connection : {9U, 7U}) {
    octets += BagFile::record(
        {{"op", "\x02"}, {"conn", BagFile::number(connection)}, {"time", BagFile::time(TimeNs{connection})}},
        std::to_string(connection));
  }
  BagReader reader(folder.write("a.bag", octets), "a.bag");
  ASSERT_EQ(reader.topics().size(), 1U);
  EXPECT_EQ(reader.first_ns(), 7);
  EXPECT_THAT(played(reader, "/a"), ElementsAre("7", "9")) << "messages may stand outside of chunks";
}

TEST(BagReader, ADamagedChunkIsPassedOverWhereThereIsNoIndex) {
  const TempFolder folder;
  std::string octets = counted(40, "lz4").unclosed();
  octets[octets.find("size=") + 5] ^= 1;
  BagReader bag(folder.write("a.bag", octets), "a.bag");
  EXPECT_EQ(played(bag, "/even"), (std::vector<std::string>{})) << "it described the topics";
  EXPECT_THAT(bag.warning(), HasSubstr("is not what was written; that chunk is passed over"));
}

TEST(BagReader, SaysWhatIsNotRead) {
  const TempFolder folder;
  const auto error = [&](const std::string& octets) {
    return coslam::test::error_of<UserError>([&] { BagReader(folder.write("a.bag", octets), "a.bag"); });
  };
  EXPECT_EQ(error("nothing"), "a.bag: is no bag of ROS 1");
  EXPECT_THAT(error("#ROSBAG V1.2\n"), HasSubstr("older version than 2.0"));
  EXPECT_THAT(error(std::string(kBagMagic)), HasSubstr("it has no header"));
  EXPECT_THAT(
      error(std::string(kBagMagic) + BagFile::record({{"op", "\x03"}, {"encryptor", "rosbag/AesCbcEncryptor"}}, "")),
      HasSubstr("encrypted"));
  EXPECT_THAT(coslam::test::error_of<UserError>([&] { BagReader(folder / "none.bag", "none.bag"); }),
              HasSubstr("none.bag: cannot be read"));
  std::string other = counted(4).closed();
  other.replace(other.find("compression=none") + 12, 4, "zip7");
  BagReader bag(folder.write("a.bag", other), "a.bag");
  EXPECT_THAT(coslam::test::error_of<UserError>([&] { played(bag, "/even"); }), HasSubstr("compressed with zip7"));
}

}  // namespace
}  // namespace coslam::recording::bag_reader_test
