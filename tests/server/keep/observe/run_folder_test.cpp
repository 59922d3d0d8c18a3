// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/keep/observe/run_folder.h"

#include <gmock/gmock.h>

#include "common/base/error.h"
#include "common/dataset/result_folder.h"
#include "tests/support/temp_folder.h"

namespace coslam::run_folder_test {
namespace {

using ::testing::HasSubstr;

constexpr TimeNs kUtc_ns = 1'795'423'512'987'654'321;  // 2026-11-23 08:45:12

TEST(RunFolder, IsNamedByTimeAndRun) {
  EXPECT_EQ(run_folder_name(kUtc_ns, RunId(0x00c0ffee00c0ffee)), "20261123T084512Z-00c0ffee00c0ffee");
  EXPECT_EQ(run_folder_name(0, RunId(0xffffffffffffffff)), "19700101T000000Z-ffffffffffffffff");
}

TEST(RunFolder, EachRunHasOneOfItsOwn) {
  const test::TempFolder temp;
  const auto runs = temp / "a/b";
  make_folder_of_runs(runs);
  const auto folder = make_run_folder(runs, kUtc_ns, RunId(1));
  EXPECT_TRUE(std::filesystem::is_directory(folder));
  EXPECT_NE(make_run_folder(runs, kUtc_ns, RunId(2)), folder);
  EXPECT_THAT(test::error_of<UserError>([&] { make_run_folder(runs, kUtc_ns, RunId(1)); }),
              HasSubstr("cannot make the result folder " + folder.string() + ": File exists"));
}

TEST(RunFolder, LatestNamesTheNewest) {
  const test::TempFolder temp;
  for (const std::uint64_t run : {1, 2, 3}) {
    const auto folder = make_run_folder(temp.path(), kUtc_ns, RunId(run));
    link_latest(folder);
    EXPECT_EQ(std::filesystem::read_symlink(temp / kLatestRun), folder.filename()) << "it may move with its folder";
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(temp.path()), {}), 4) << "nothing else is left";
}

TEST(RunFolder, LatestReplacesNothingButALink) {
  const test::TempFolder temp;
  temp.write("latest/report.json", "mine");
  EXPECT_THAT(test::error_of<UserError>([&] { link_latest(make_run_folder(temp.path(), kUtc_ns, RunId(1))); }),
              HasSubstr("latest name the newest run"));
  EXPECT_TRUE(std::filesystem::exists(temp / "latest/report.json"));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(temp.path()), {}), 2);
}

TEST(RunFolder, SaysWhyItCannotBeMade) {
  const test::TempFolder temp;
  temp.write("file", "");
  EXPECT_THAT(test::error_of<UserError>([&] { make_folder_of_runs(temp / "file/runs"); }),
              HasSubstr("cannot make the result folder " + (temp / "file/runs").string()));
}

}  // namespace
}  // namespace coslam::run_folder_test
