// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/dataset/file.h"

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <csignal>
#include <iterator>

#include "common/base/error.h"
#include "tests/support/temp_folder.h"

namespace coslam::file_test {
namespace {

using ::testing::HasSubstr;

constexpr auto kAtOnce = OutputFile::Shows::kAtOnce, kWhole = OutputFile::Shows::kWhole;

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

class OutputFileTest : public ::testing::Test {
 protected:
  test::TempFolder temp_;
  const std::filesystem::path file_ = temp_ / "folder/file";
};

TEST_F(OutputFileTest, OneThatGrowsShowsWhatWasFlushed) {
  OutputFile out(file_, kAtOnce);
  EXPECT_EQ(text_of(file_), "");
  out.write("one\n");
  out.flush();
  EXPECT_EQ(text_of(file_), "one\n");
  out.write("two\n");
  EXPECT_EQ(out.bytes(), 8U);
  out.cut(4);
  out.write("three\n");
  out.close();
  EXPECT_EQ(text_of(file_), "one\nthree\n");
}

TEST_F(OutputFileTest, OneThatIsNotClosedIsCompleteAllTheSame) {
  {
    OutputFile out(file_, kAtOnce);
    out.write("one\n");
  }
  EXPECT_EQ(text_of(file_), "one\n");
}

TEST_F(OutputFileTest, AWholeOneTakesThePlaceOfTheOneBefore) {
  temp_.write("folder/file", "before");
  {
    OutputFile out(file_, kWhole);
    out.write("a part");
    out.flush();
    EXPECT_EQ(text_of(file_), "before");
  }
  EXPECT_EQ(text_of(file_), "before") << "it was given up";
  OutputFile out(file_, kWhole);
  out.write("after");
  out.close();
  EXPECT_EQ(text_of(file_), "after");
  EXPECT_FALSE(std::filesystem::exists(file_.string() + ".new"));
}

TEST_F(OutputFileTest, AKillLeavesTheOneBefore) {
  temp_.write("folder/file", "before");
  const auto die = [this] {
    OutputFile out(file_, kWhole);
    out.write("a part");
    out.flush();
    std::raise(SIGKILL);
  };
  EXPECT_EXIT(die(), ::testing::KilledBySignal(SIGKILL), "");
  EXPECT_EQ(text_of(file_), "before");
}

TEST_F(OutputFileTest, AFullDiskIsSaidOnceWithFileAndCause) {
  std::filesystem::create_directories(file_.parent_path());
  std::filesystem::create_symlink("/dev/full", file_);
  OutputFile out(file_, kAtOnce);
  out.write("one\n");
  EXPECT_FALSE(out.take_problem()) << "nobody knows yet";
  out.flush();
  EXPECT_EQ(out.take_problem(), file_.string() + ": cannot be written: No space left on device");
  out.write("two\n");
  out.flush();
  EXPECT_FALSE(out.take_problem());
  EXPECT_THAT(test::error_of<UserError>([&] { out.check(); }), HasSubstr("No space left on device"));
  EXPECT_THAT(test::error_of<UserError>([&] { out.close(); }), HasSubstr("No space left on device"));
}

// A limit on the size of files stands for a disk that is full for a while.
TEST_F(OutputFileTest, WhatAFullDiskDidNotTakeIsWrittenWhenItHasRoom) {
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto limit = [&](rlim_t bytes) {
    const rlimit now{bytes, before.rlim_max};
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &now), 0);
  };
  OutputFile out(file_, kAtOnce);
  out.write("one\n");
  out.flush();
  limit(6);
  out.write("two\n");
  out.flush();
  EXPECT_THAT(out.take_problem().value_or(""), HasSubstr("cannot be written"));
  EXPECT_FALSE(out.ended());
  out.write("three\n");
  EXPECT_EQ(text_of(file_), "one\n") << "whole lines only";
  out.cut(8);
  out.write("four\n");
  limit(before.rlim_cur);
  out.check();
  EXPECT_FALSE(out.take_problem());
  EXPECT_EQ(text_of(file_), "one\ntwo\nfour\n");
}

TEST_F(OutputFileTest, ADiskThatStaysFullEndsIt) {
  std::filesystem::create_directories(file_.parent_path());
  std::filesystem::create_symlink("/dev/full", file_);
  OutputFile out(file_, kAtOnce);
  const std::string line(1U << 20U, 'x');
  out.write(line);
  EXPECT_TRUE(out.take_problem());
  for (int i = 0; i < 20; ++i) {
    out.write(line);
    EXPECT_ANY_THROW(out.check());
  }
  EXPECT_TRUE(out.ended());
  EXPECT_TRUE(out.take_problem()) << "said once more";
  EXPECT_FALSE(out.take_problem());
}

TEST_F(OutputFileTest, AFullDiskLeavesTheWholeOneBefore) {
  temp_.write("folder/file", "before");
  std::filesystem::create_symlink("/dev/full", file_.string() + ".new");
  OutputFile out(file_, kWhole);
  out.write("after");
  EXPECT_THAT(test::error_of<UserError>([&] { out.close(); }),
              HasSubstr(file_.string() + ": cannot be written: No space"));
  EXPECT_EQ(text_of(file_), "before");
  EXPECT_FALSE(std::filesystem::exists(std::filesystem::symlink_status(file_.string() + ".new")));
}

TEST_F(OutputFileTest, SaysWhyItCannotBeMade) {
  temp_.write("folder", "");
  for (const auto shows : {kAtOnce, kWhole}) {
    EXPECT_EQ(test::error_of<UserError>([&] { OutputFile(file_, shows); }),
              file_.string() + ": cannot be written: Not a directory");
  }
}

}  // namespace
}  // namespace coslam::file_test
