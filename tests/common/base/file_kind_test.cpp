// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/base/file_kind.h"

#include <gmock/gmock.h>

#include "tests/support/temp_folder.h"

namespace coslam::file_kind_test {
namespace {

using ::testing::HasSubstr;

class FileKind : public ::testing::Test {
 protected:
  std::string kind(const std::string& text) const { return but_it_is(temp_.write("file", text)); }

  test::TempFolder temp_;
};

TEST_F(FileKind, IsToldByHowAFileBegins) {
  std::string map = "SQLite format 3";
  map.resize(68);
  EXPECT_THAT(kind(map + "COSL and rows"), HasSubstr("; it is a map file"));
  EXPECT_EQ(kind(map + "another's"), "");
  EXPECT_THAT(kind("CoSLAMrc 1"), HasSubstr("coslam replay"));
  EXPECT_THAT(kind("\x89PNG\r\n"), HasSubstr("picture"));
  EXPECT_EQ(kind(""), "; it is empty");
  EXPECT_EQ(kind("SQLite format 3"), "");
  EXPECT_EQ(kind("1 2 3\n"), "");
}

TEST_F(FileKind, OfYaml) {
  EXPECT_THAT(kind("# two\nagents:\n  - {name: a, source: a}\n"), HasSubstr("coslam run"));
  EXPECT_THAT(kind("id: a\nsource: v4l2:0\n"), HasSubstr("coslam-agent --config"));
  EXPECT_THAT(kind("agents: [a]\nserver: {theta: 3}\n"), HasSubstr("coslam-server --config"));
  EXPECT_THAT(kind("bridge: {}\n"), HasSubstr("coslam-bridge --config"));
  EXPECT_THAT(kind("width: 640\nfx: 400\n"), HasSubstr("calibration"));
  EXPECT_EQ(kind("a: b\n"), "");
}

TEST_F(FileKind, OfFolders) {
  EXPECT_EQ(but_it_is(temp_.path()), "");
  EXPECT_EQ(but_it_is(temp_ / "nowhere"), "");
  temp_.write("sequence.yaml", "");
  EXPECT_THAT(but_it_is(temp_.path()), HasSubstr("sequence"));
  temp_.write("report.json", "{}");
  EXPECT_THAT(but_it_is(temp_.path()), HasSubstr("coslam view"));
}

TEST_F(FileKind, WhyAFileCannotBeRead) {
  EXPECT_EQ(why_unreadable(temp_ / "nowhere"), ": there is no such file");
  EXPECT_EQ(why_unreadable(temp_.path()), ": it is a folder");
  EXPECT_EQ(why_unreadable(temp_.write("file", "a")), "");
}

}  // namespace
}  // namespace coslam::file_kind_test
