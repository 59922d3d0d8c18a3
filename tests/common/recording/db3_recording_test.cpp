// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <fstream>

#include "common/base/error.h"
#include "common/recording/containers.h"
#include "tests/common/mcap/mcap_file.h"
#include "tests/common/recording/db3_file.h"
#include "tests/common/recording/played.h"
#include "tests/support/temp_folder.h"

namespace coslam::recording::db3_recording_test {
namespace {

using coslam::test::TempFolder;
using test::counted_db3;
using test::Db3File;
using test::numbers;
using test::played;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string error_of_opening(const std::filesystem::path& file) {
  return coslam::test::error_of<UserError>([&] { open_db3(file, "a.db3"); });
}

TEST(Db3Recording, ReadsWhatWasWritten) {
  const TempFolder folder;
  counted_db3(folder / "a b%20#?.db3", 3, 200);
  const auto db3 = open_db3(folder / "a b%20#?.db3", "a.db3");
  EXPECT_EQ(db3->warning(), "");
  EXPECT_THAT(db3->topics(),
              ElementsAre(Topic{"/even", "std_msgs/msg/String", "cdr"}, Topic{"/odd", "a/msg/B", "cdr"}));
  EXPECT_EQ(db3->first_ns(), 3'000'000);
  EXPECT_EQ(played(*db3, "/even"), numbers(4, 200, 2));
  EXPECT_EQ(played(*db3, "/odd"), numbers(3, 200, 2));
}

TEST(Db3Recording, MessagesComeByTime) {
  const TempFolder folder;
  {
    Db3File file(folder / "a.db3");
    const auto topic = file.add_topic("/a", "a/msg/A");
    for (const int t : {5, 1, 4, 2, 6, 3, 0}) file.add(topic, t, std::to_string(t));
  }
  const auto db3 = open_db3(folder / "a.db3", "a.db3");
  EXPECT_EQ(played(*db3, "/a"), numbers(0, 7));
}

TEST(Db3Recording, TimesThatAreNoneStayInRange) {
  const TempFolder folder;
  {
    Db3File file(folder / "a.db3");
    const auto topic = file.add_topic("/a", "a/msg/A");
    file.add(topic, std::numeric_limits<TimeNs>::min(), "first");
    file.add(topic, std::numeric_limits<TimeNs>::max(), "last");
  }
  const auto db3 = open_db3(folder / "a.db3", "a.db3");
  EXPECT_EQ(db3->first_ns(), 0);
  EXPECT_THAT(played(*db3, "/a"), ElementsAre("first", "last"));
}

TEST(Db3Recording, WhatIsInTheLogOfARecorderThatWasKilledIsRead) {
  const TempFolder folder;
  Db3File file(folder / "a.db3");
  file.exec("PRAGMA journal_mode = WAL");
  const auto topic = file.add_topic("/a", "a/msg/A");
  for (int i = 0; i < 5; ++i) file.add(topic, i, std::to_string(i));
  const auto db3 = open_db3(folder / "a.db3", "a.db3");  // while the recorder still has it
  EXPECT_EQ(played(*db3, "/a"), numbers(0, 5));
}

TEST(Db3Recording, CutOffItIsReadUntilThere) {
  const TempFolder folder;
  const auto message = [](std::size_t i) { return std::string(1500, static_cast<char>('a' + i % 26)); };
  constexpr std::size_t kMessages = 100;
  {
    Db3File file(folder / "whole.db3");
    const auto topic = file.add_topic("/a", "a/msg/A");
    for (std::size_t i = 0; i < kMessages; ++i) file.add(topic, static_cast<TimeNs>(i), message(i));
  }
  const std::string whole = mcap::test::octets_in(folder / "whole.db3");
  std::size_t least = kMessages;
  for (std::size_t size = whole.size() - 700; size > whole.size() / 3; size -= 3333) {
    const auto db3 = open_db3(folder.write("a.db3", whole.substr(0, size)), "a.db3");
    EXPECT_EQ(db3->warning(), "a.db3: was cut off, what is there is read");
    const auto octets = played(*db3, "/a");
    for (std::size_t i = 0; i < octets.size(); ++i) EXPECT_EQ(octets[i], message(i)) << size;
    EXPECT_LE(octets.size(), least);
    EXPECT_GE(octets.size() + 4, size / 2048) << "a message is four pages";
    least = octets.size();
  }
  EXPECT_LT(least, kMessages / 2);
}

TEST(Db3Recording, AnOctetThatChangedBreaksNothing) {
  const TempFolder folder;
  counted_db3(folder / "whole.db3", 0, 100);
  const std::string whole = mcap::test::octets_in(folder / "whole.db3");
  for (std::size_t at = 0; at < whole.size(); at += 23) {
    std::string changed = whole;
    changed[at] = static_cast<char>(changed[at] ^ 0x41);
    const auto file = folder.write("a.db3", changed);
    try {
      played(*open_db3(file, "a.db3"), "/even");
    } catch (const UserError& e) {
      EXPECT_THAT(e.what(), HasSubstr("a.db3: "));
    }
  }
}

TEST(Db3Recording, OnlyTablesAreRead) {
  const TempFolder folder;
  {
    SQLite::Database database((folder / "a.db3").string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
    database.exec("CREATE TABLE topics(id INTEGER PRIMARY KEY, name, type, serialization_format)");
    database.exec(
        "CREATE VIEW messages AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT i AS id, 1 AS "
        "topic_id, i AS timestamp, i AS data FROM n");
  }
  EXPECT_EQ(error_of_opening(folder / "a.db3"), "a.db3: is no recording of rosbag2: it has no table messages");
}

TEST(Db3Recording, SaysWhatAFileIsNot) {
  const TempFolder folder;
  EXPECT_THAT(error_of_opening(folder / "none.db3"), HasSubstr("a.db3: is damaged, or no recording of rosbag2"));
  EXPECT_THAT(error_of_opening(folder.write("b.db3", std::string("SQLite format 3\0something else", 30))),
              HasSubstr("a.db3: is damaged, or no recording of rosbag2"));
}

}  // namespace
}  // namespace coslam::recording::db3_recording_test
