// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/dataset/file.h"

#include <gmock/gmock.h>

#include <csignal>
#include <iterator>

#include "common/base/error.h"
#include "tests/support/temp_folder.h"

namespace coslam {
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
}  // namespace coslam
