// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/keep/store/map_file.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>
#include <csignal>

#include <fstream>

#include "common/base/error.h"
#include "tests/support/temp_folder.h"

namespace coslam::map_file_test {
namespace {

using testing::HasSubstr;
using Access = MapFile::Access;

std::string octets(int seed, std::size_t size = 300) {
  std::string out(size, '\0');
  for (std::size_t i = 0; i < size; ++i) out[i] = static_cast<char>(seed * 7 + static_cast<int>(i) * 13);
  return out;
}

class MapFileTest : public testing::Test {
 protected:
  void write_some(int rows = 200) {
    MapFile file(path_, Access::kWrite);
    std::vector<Row> all;
    for (int i = 0; i < rows; ++i) all.push_back({"point", i, octets(i)});
    file.write(all, 42);
  }
  std::string why_not(Access access = Access::kWrite) {
    return test::error_of<UserError>([&] { MapFile(path_, access).check(); });
  }
  std::string content() const {
    std::ifstream in(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  const test::TempFolder folder_;
  const std::filesystem::path path_ = folder_ / "a.map";
};

TEST_F(MapFileTest, GivesBackWhatWasWritten) {
  {
    MapFile file(path_, Access::kWrite);
    EXPECT_TRUE(file.read().empty());
    EXPECT_EQ(file.saved_ns(), std::nullopt);
    file.write(std::vector<Row>{{"point", 3, octets(3)}, {"point", 4, octets(4)}, {"frame", -1, octets(5)}}, 7);
    file.write(std::vector<Row>{{"point", 3, octets(6)}, {"point", 4, {}}}, 8);
  }
  const MapFile file(path_, Access::kRead);
  EXPECT_EQ(file.read(), (Tables{{"point", {{3, octets(6)}}}, {"frame", {{-1, octets(5)}}}}));
  EXPECT_EQ(file.saved_ns(), 8);
  file.check();
}

TEST_F(MapFileTest, OnlyOneMayHaveIt) {
  write_some();
  const MapFile first(path_, Access::kWrite);
  const std::string before = content();
  EXPECT_THAT(why_not(), HasSubstr("in use by another process"));
  EXPECT_EQ(content(), before);
}

// Viewers see what was written last, and neither they nor the writer wait for each other.
TEST_F(MapFileTest, OthersMayReadIt) {
  int go[2];
  ASSERT_EQ(pipe(go), 0);
  const pid_t child = fork();
  if (child == 0) {  // before the writer has it: SQLite does not outlive a fork
    char word = 0;
    if (read(go[0], &word, 1) != 1) _exit(2);
    const MapFile reader(path_, Access::kRead);
    reader.check();
    _exit(reader.read().at("point").size() == 1 && reader.saved_ns() == 5 ? 0 : 1);
  }
  MapFile writer(path_, Access::kWrite);
  writer.write(std::vector<Row>{{"point", 1, octets(1)}}, 5);
  ASSERT_EQ(write(go[1], "g", 1), 1);
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  writer.write(std::vector<Row>{{"point", 2, octets(2)}}, 6);
  EXPECT_EQ(writer.read().at("point").size(), 2U);
  close(go[0]);
  close(go[1]);
}

TEST_F(MapFileTest, TablesOfThePastStayOnDisk) {
  MapFile file(path_, Access::kWrite);
  file.write(std::vector<Row>{{"point", 1, octets(1)}, {"past_frame", 3, octets(3)}, {"past_frame", 2, octets(2)}}, 5);
  EXPECT_EQ(file.read(), (Tables{{"point", {{1, octets(1)}}}}));
  std::vector<std::string> read;
  file.for_each_row("past_frame", 0, 2, [&](const std::string& o) { read.push_back(o); });
  EXPECT_EQ(read, std::vector{octets(2)});
  file.for_each_row("past_frame", 0, 9, [&](const std::string& o) { read.push_back(o); });
  EXPECT_EQ(read, (std::vector{octets(2), octets(2), octets(3)}));
}

// Killed in the middle of a transaction: the one before is there.
TEST_F(MapFileTest, OutlivesAKill) {
  write_some(3);
  const pid_t child = fork();
  if (child == 0) {
    MapFile file(path_, Access::kWrite);
    file.write(std::vector<Row>{{"point", 100, octets(1)}}, 50);
    std::vector<Row> large;
    for (int i = 0; i < 20000; ++i) large.push_back({"point", 1000 + i, octets(i)});
    alarm(0);
    ualarm(3000, 0);  // ends the process, wherever it is
    for (;;) file.write(large, 51);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));
  const MapFile file(path_, Access::kWrite);
  file.check();
  const std::size_t rows = file.read().at("point").size();
  EXPECT_TRUE(rows == 4 || rows == 20004) << rows;
  EXPECT_EQ(file.saved_ns(), rows == 4 ? 50 : 51);
}

TEST_F(MapFileTest, ACopyThatWasTakenWhileItWasWrittenIsWholeOrRefused) {
  write_some(10);
  const std::filesystem::path copy = folder_ / "copy.map", whole = folder_ / "whole.map";
  const auto why_not_copy = [&](Access access) {
    return test::error_of<UserError>([&] { MapFile(copy, access).check(); });
  };
  std::filesystem::copy_file(path_, copy);
  EXPECT_EQ(why_not_copy(Access::kRead), "") << "nobody wrote it";
  MapFile file(path_, Access::kWrite);
  std::filesystem::copy_file(path_, copy, std::filesystem::copy_options::overwrite_existing);
  EXPECT_EQ(why_not_copy(Access::kRead), "") << "nothing was written yet";
  file.write(std::vector<Row>{{"point", 3, octets(6)}}, 43);
  std::filesystem::copy_file(path_, copy, std::filesystem::copy_options::overwrite_existing);
  EXPECT_THAT(why_not_copy(Access::kRead), HasSubstr("copy.map was copied while it was written"));
  EXPECT_THAT(why_not_copy(Access::kWrite), HasSubstr("copy it together with copy.map-wal"));
  std::filesystem::copy_file(folder_ / "a.map-wal", folder_ / "copy.map-wal");
  EXPECT_EQ(why_not_copy(Access::kRead), "");
  EXPECT_EQ(MapFile(copy, Access::kRead).saved_ns(), 43);
  MapFile(path_, Access::kRead).copy_to(whole);
  EXPECT_EQ(MapFile(whole, Access::kRead).saved_ns(), 43);
  EXPECT_EQ(MapFile(whole, Access::kRead).read(), file.read());
  MapFile(whole, Access::kWrite).write({}, 44);
  EXPECT_THAT(test::error_of<UserError>([&] { file.copy_to(whole); }), HasSubstr("whole.map is there already"));
}

TEST_F(MapFileTest, WhoOpensItAfterAKillLeavesItWhole) {
  write_some(3);
  const pid_t child = fork();
  if (child == 0) {
    MapFile file(path_, Access::kWrite);
    file.write(std::vector<Row>{{"point", 100, octets(1)}}, 50);
    kill(getpid(), SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  { MapFile file(path_, Access::kWrite); }  // writes nothing
  EXPECT_EQ(why_not(Access::kRead), "");
  EXPECT_EQ(MapFile(path_, Access::kRead).saved_ns(), 50);
}

TEST_F(MapFileTest, OnceClosedItIsWholeByItself) {
  write_some(10);
  write_some(20);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a.map-wal"));
  std::filesystem::copy_file(path_, folder_ / "b.map");
  EXPECT_EQ(MapFile(folder_ / "b.map", Access::kRead).read().at("point").size(), 20U);
}

TEST_F(MapFileTest, AFlippedBitIsNoticed) {
  write_some();
  std::string damaged = content();
  const std::size_t at = damaged.find(octets(120).substr(50, 20));
  ASSERT_NE(at, std::string::npos);
  damaged[at] ^= 4;
  std::ofstream(path_, std::ios::binary) << damaged;
  EXPECT_THAT(why_not(), testing::ContainsRegex("a.map is damaged: point [0-9]+ differs from its check sum"));
  EXPECT_EQ(content(), damaged) << "nothing is overwritten";
}

TEST_F(MapFileTest, ATruncatedFileIsNoticed) {
  write_some();
  const std::string whole = content();
  for (const std::size_t size : {whole.size() / 2, whole.size() - 4096, std::size_t{100}, std::size_t{5}}) {
    std::ofstream(path_, std::ios::binary | std::ios::trunc) << whole.substr(0, size);
    EXPECT_THAT(why_not(), testing::AnyOf(HasSubstr("is damaged"), HasSubstr("is no map"))) << size;
  }
}

TEST_F(MapFileTest, WhatIsNoMapIsLeftAlone) {
  folder_.write("a.map", "trajectory of yesterday, of which there is no other copy\n");
  const std::string before = content();
  EXPECT_THAT(why_not(), HasSubstr("is no map of CoSLAM"));
  EXPECT_EQ(content(), before);
  std::filesystem::remove(path_);
  SQLite::Database(path_.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE).exec("CREATE TABLE notes (n INTEGER)");
  EXPECT_THAT(why_not(), HasSubstr("is no map of CoSLAM")) << "somebody else's data base";
  EXPECT_THAT(why_not(Access::kRead), HasSubstr("is no map of CoSLAM"));
}

TEST_F(MapFileTest, OfANewerVersion) {
  write_some();
  SQLite::Database(path_.string(), SQLite::OPEN_READWRITE).exec("PRAGMA user_version=99");
  EXPECT_THAT(why_not(), HasSubstr("of version 99, newer than this program's"));
}

TEST_F(MapFileTest, NotThere) {
  EXPECT_THAT(why_not(Access::kRead), HasSubstr("there is no map file"));
  EXPECT_FALSE(std::filesystem::exists(path_));
}

TEST_F(MapFileTest, OfAnotherUser) {
  if (geteuid() == 0) GTEST_SKIP() << "root may write everything";
  write_some();
  std::filesystem::permissions(path_, std::filesystem::perms::owner_read);
  EXPECT_THAT(why_not(), HasSubstr("may not be written by this user"));
}

TEST_F(MapFileTest, SaysWhatIsInTheWay) {
  const auto why = [&](const std::filesystem::path& file) {
    return test::error_of<UserError>([&] { MapFile(file, Access::kWrite); });
  };
  EXPECT_THAT(why(folder_ / "not there" / "a.map"), HasSubstr("there is no folder"));
  EXPECT_THAT(why(folder_.path()), HasSubstr("is a folder"));
  EXPECT_THAT(test::error_of<UserError>([&] { MapFile(folder_.path(), Access::kRead); }), HasSubstr("is a folder"));
  ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  EXPECT_THAT(why(folder_ / "pipe"), HasSubstr("pipe is no file")) << "nobody ever writes to it";
  folder_.write("a.map", "");
  EXPECT_THAT(why_not(Access::kRead), HasSubstr("a.map is empty"));
  EXPECT_EQ(why_not(Access::kWrite), "") << "a new map";
}

TEST_F(MapFileTest, IsReadWhereNothingMayBeWritten) {
  if (geteuid() == 0) GTEST_SKIP() << "root may write everything";
  write_some();
  using std::filesystem::perms;
  std::filesystem::permissions(folder_.path(), perms::owner_read | perms::owner_exec);
  EXPECT_EQ(why_not(Access::kRead), "");
  EXPECT_THAT(why_not(Access::kWrite), HasSubstr("this user may not write in the folder"));
  std::filesystem::permissions(folder_.path(), perms::owner_all);
}

TEST_F(MapFileTest, GivesRoomBack) {
  write_some(2000);
  MapFile file(path_, Access::kWrite);
  const auto before = std::filesystem::file_size(path_);
  std::vector<Row> gone;
  for (int i = 10; i < 2000; ++i) gone.push_back({"point", i, {}});
  file.write(gone, 43);
  file.compact();
  EXPECT_LT(std::filesystem::file_size(path_), before / 10);
  EXPECT_EQ(file.read().at("point").size(), 10U);
}

}  // namespace
}  // namespace coslam::map_file_test
