// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/run/played.h"

#include <gmock/gmock.h>

#include "common/dataset/result.h"
#include "tests/support/temp_folder.h"

namespace coslam::played_test {
namespace {

using testing::HasSubstr;

class PlayedTest : public testing::Test {
 protected:
  PlayedTest() {
    sequence_.name = "walk";
    sequence_.file = "/data/walk/sequence.yaml";
    sequence_.agents = {{.name = "a", .source = "/data/walk/a.mp4", .calibration = "/data/walk/a.yaml", .start_s = 1.5},
                        {.name = "b", .source = "rtsp://me:secret@10.0.0.1/b"}};
    write_json(result_.report(), {{"version", "1"}, {"agents", {}}, {"configuration", {{"server", 1}}}});
  }
  test::TempFolder folder_;
  ResultFolder result_{folder_ / "result"};
  Sequence sequence_;
};

TEST_F(PlayedTest, AReportNamesItsSequenceAndTheAgentsSettings) {
  note_played(sequence_, {"agent.tracker.max_tracks=123"}, result_);
  const nlohmann::json report = read_json(result_.report());
  EXPECT_EQ(report["sequence"]["name"], "walk");
  EXPECT_EQ(report["sequence"]["file"], "/data/walk/sequence.yaml");
  EXPECT_EQ(report["sequence"]["agents"]["a"]["calibration"], "/data/walk/a.yaml");
  EXPECT_EQ(report["sequence"]["agents"]["a"]["start_s"], 1.5);
  EXPECT_THAT(report["sequence"]["agents"]["b"]["source"].get<std::string>(), Not(HasSubstr("secret")));
  EXPECT_EQ(report["configuration"]["server"], 1);
  EXPECT_EQ(report["configuration"]["agent"]["tracker"]["max_tracks"], 123);
}

TEST_F(PlayedTest, AnotherSequenceThanThatOfTheResultIsSaid) {
  EXPECT_EQ(of_another_sequence(sequence_, result_), "") << "not known";
  note_played(sequence_, {}, result_);
  EXPECT_EQ(of_another_sequence(sequence_, result_), "");
  Sequence other = sequence_;
  other.name = "run";
  EXPECT_EQ(of_another_sequence(other, result_), "") << "the same images under another name";
  other.agents[0].source = "/data/run/a.mp4";
  EXPECT_THAT(of_another_sequence(other, result_), HasSubstr("whose a is /data/walk/a.mp4, not /data/run/a.mp4"));
  Sequence moved = sequence_;
  moved.agents[0].source = "/mnt/walk/a.mp4";
  EXPECT_EQ(of_another_sequence(moved, result_), "") << "it was moved";
}

TEST_F(PlayedTest, WithoutAReportNothingIsNoted) {
  const ResultFolder none(folder_ / "none");
  note_played(sequence_, {}, none);
  EXPECT_FALSE(std::filesystem::exists(none.report()));
  EXPECT_EQ(of_another_sequence(sequence_, none), "");
}

}  // namespace
}  // namespace coslam::played_test
