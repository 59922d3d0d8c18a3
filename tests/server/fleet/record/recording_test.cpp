// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/record/recording.h"

#include <gmock/gmock.h>

#include "common/base/error.h"
#include "tests/support/temp_folder.h"
#include "tests/support/wire_values.h"

namespace coslam::recording_test {
namespace {

using test::error_of;
using ::testing::HasSubstr;

class RecordingTest : public ::testing::Test {
 protected:
  std::filesystem::path written(const std::vector<Record>& records) {
    auto file = temp_ / (std::to_string(++files_) + ".rec");
    RecordWriter writer(file);
    for (const Record& record : records) EXPECT_EQ(writer.write(record), 0);
    return file;
  }
  Record head() const { return encode_head({"1", RunId(1), 5, 6, nlohmann::ordered_json::object()}); }
  Record hello(const std::string& agent, std::uint64_t run) {
    return encode_event(values_.hello(agent, RunId(run)), 10);
  }
  Record frame(const std::string& agent, std::uint64_t run, std::uint32_t number) {
    return encode_event(JoinedFrame{values_.frame(agent, RunId(run), number, 5), {}, {}}, 20);
  }
  std::string problem(const std::vector<Record>& records) {
    return error_of<UserError>([&] { check_recording(written(records)); });
  }

  test::TempFolder temp_;
  test::WireValues values_{1};
  int files_ = 0;
};

TEST_F(RecordingTest, TellsWhetherItWasEnded) {
  std::vector<Record> records{head(), hello("cam0", 1), frame("cam0", 1, 0), frame("cam0", 1, 3)};
  RecordingSummary cut = check_recording(written(records));
  EXPECT_TRUE(cut.cut_off);
  EXPECT_EQ(cut.t_ns, 20);
  records.push_back({RecordType::kEnd, 30, {}});
  const RecordingSummary whole = check_recording(written(records));
  EXPECT_FALSE(whole.cut_off);
  EXPECT_EQ(whole.t_ns, 30);
  EXPECT_EQ(whole.head.server_run, RunId(1));
}

TEST_F(RecordingTest, KeepsTheOrderOfALink) {
  const std::string reason = "is not one that coslam writes";
  EXPECT_EQ(problem({head(), hello("cam0", 1), frame("cam0", 1, 7), frame("cam0", 1, 8)}), "");
  EXPECT_THAT(problem({head(), frame("cam0", 1, 0)}), HasSubstr(reason)) << "before its hello";
  EXPECT_THAT(problem({head(), hello("cam0", 1), frame("cam0", 2, 0)}), HasSubstr(reason)) << "of another run";
  EXPECT_THAT(problem({head(), hello("cam0", 1), frame("cam1", 1, 0)}), HasSubstr(reason)) << "of another name";
  EXPECT_THAT(problem({head(), hello("cam0", 1), frame("cam0", 1, 7), frame("cam0", 1, 7)}), HasSubstr(reason));
  EXPECT_THAT(problem({head(), head()}), HasSubstr(reason));
}

TEST_F(RecordingTest, NeedsItsHead) {
  EXPECT_THAT(problem({}), HasSubstr("cut off before anything was recorded"));
  EXPECT_THAT(problem({hello("cam0", 1)}), HasSubstr("is no head of a recording"));
  const std::string other = R"({"protocol":1})";
  EXPECT_THAT(problem({{RecordType::kHead, 0, {other.begin(), other.end()}}}),
              HasSubstr("has messages of protocol 1, and this program reads"));
}

}  // namespace
}  // namespace coslam::recording_test
