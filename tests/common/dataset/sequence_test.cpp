// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/dataset/sequence.h"

#include <gmock/gmock.h>

#include "common/base/error.h"
#include "tests/support/temp_folder.h"

namespace coslam::sequence_test {
namespace {

using ::testing::HasSubstr;

class SequenceFile : public ::testing::Test {
 protected:
  SequenceFile() {
    for (const char* name : {"cam0.csv", "cam1.csv", "calib.yaml", "cam0.tum", "points.csv", "masks/x"}) {
      folder_.write(name, "");
    }
  }
  Sequence load(const std::string& text) { return load_sequence(folder_.write("sequence.yaml", text)); }
  std::string error(const std::string& text) {
    return test::error_of<UserError>([&] { load(text); });
  }

  test::TempFolder folder_;
  const std::string agent_ = "agents: [{name: cam0, source: cam0.csv, calibration: calib.yaml}]\n";
};

TEST_F(SequenceFile, RecordedTopics) {
  folder_.write("walk.mcap", "");
  const Sequence s = load(
      "agents: [{name: a, source: 'mcap:walk.mcap#/left/image_raw', calibration: "
      "'mcap:./walk.mcap#/left/camera_info'}]\n");
  const std::string file = "mcap:" + (folder_ / "walk.mcap").string();
  EXPECT_EQ(s.agents[0].source, file + "#/left/image_raw");
  EXPECT_EQ(s.agents[0].calibration.string(), file + "#/left/camera_info");
  EXPECT_THAT(error("agents: [{name: a, source: 'mcap:none.mcap#/x', calibration: calib.yaml}]\n"),
              HasSubstr("none.mcap"));
}

TEST_F(SequenceFile, RecordingsOfEveryKind) {
  folder_.write("walk/metadata.yaml", "");
  folder_.write("a#1.bag", "");
  const Sequence s = load(
      "agents: [{name: a, source: 'bag:walk#/left/image_raw', calibration: 'walk#/left/camera_info'},\n"
      "         {name: b, source: 'bag:a#1.bag', calibration: 'bag:a#1.bag#/left/camera_info'}]\n");
  const std::string walk = (folder_ / "walk").string(), bag = (folder_ / "a#1.bag").string();
  EXPECT_EQ(s.agents[0].source, "bag:" + walk + "#/left/image_raw");
  EXPECT_EQ(s.agents[0].calibration.string(), walk + "#/left/camera_info");
  EXPECT_EQ(s.agents[1].source, "bag:" + bag) << "a name may have a # itself, as long as there is such a file";
  EXPECT_EQ(s.agents[1].calibration.string(), "bag:" + bag + "#/left/camera_info");
}

TEST_F(SequenceFile, BlockStyle) {
  const Sequence s = load(R"(
name: walking-man
rate_hz: 25
scale:
  baseline_m: 0.8
agents:
  - name: cam0
    source: cam0.csv
    calibration: calib.yaml
    start_s: -1.5
    duration_s: 10
    truth: cam0.tum
    covered: [[2, 4.5], [7, 8]]
  - name: cam1
    source: v4l2:0
    calibration: calib.yaml
truth_points: points.csv
masks: masks
overlap: points.csv
scene: walking-man
scene_seed: 7
)");
  EXPECT_EQ(s.name, "walking-man");
  EXPECT_EQ(s.rate_hz, 25);
  EXPECT_EQ(s.baseline_m, 0.8);
  ASSERT_EQ(s.agents.size(), 2u);
  EXPECT_EQ(s.agents[0].name, "cam0");
  EXPECT_EQ(s.agents[0].source, (folder_ / "cam0.csv").string());
  EXPECT_EQ(s.agents[0].calibration, folder_ / "calib.yaml");
  EXPECT_EQ(s.agents[0].start_s, -1.5);
  EXPECT_EQ(s.agents[0].duration_s, 10);
  EXPECT_EQ(s.agents[0].truth, folder_ / "cam0.tum");
  ASSERT_EQ(s.agents[0].covered.size(), 2u);
  EXPECT_EQ(s.agents[0].covered[0].from_s, 2);
  EXPECT_EQ(s.agents[0].covered[0].to_s, 4.5);
  EXPECT_EQ(s.agents[1].source, "v4l2:0");
  EXPECT_EQ(s.agents[1].start_s, 0);
  EXPECT_FALSE(s.agents[1].duration_s);
  EXPECT_FALSE(s.agents[1].truth);
  EXPECT_EQ(s.truth_points, folder_ / "points.csv");
  EXPECT_EQ(s.masks, folder_ / "masks");
  EXPECT_EQ(s.overlap, folder_ / "points.csv");
  EXPECT_EQ(s.scene, "walking-man");
  EXPECT_EQ(s.scene_seed, 7u);
}

TEST_F(SequenceFile, FlowStyleAndDefaults) {
  const Sequence s = load("scale: {baseline_m: 0.12}\n" + agent_);
  EXPECT_EQ(s.name, "sequence");
  EXPECT_EQ(s.rate_hz, 30);
  EXPECT_EQ(s.baseline_m, 0.12);
  EXPECT_TRUE(s.scene.empty());
  EXPECT_EQ(load_sequence(folder_.path()).agents.size(), 1u);
}

TEST_F(SequenceFile, WhenARecordingBeganMayBeLeftOpen) {
  const Sequence s = load("agents: [{name: a, source: cam0.csv}, {name: b, source: cam0.csv, start_s: auto}]");
  EXPECT_FALSE(s.agents[0].start_is_open);
  EXPECT_TRUE(s.agents[1].start_is_open);
  EXPECT_EQ(s.agents[1].start_s, 0);
  EXPECT_THAT(error("agents: [{name: a, source: 'v4l2:0', start_s: auto}]"), HasSubstr("auto is for recordings"));
}

TEST_F(SequenceFile, TopicsOfNodesAreTakenAsTheyAre) {
  const Sequence s = load("agents: [{name: a, source: 'ros2:/image?domain=3', calibration: 'ros2:/camera_info'}]");
  EXPECT_EQ(s.agents[0].source, "ros2:/image?domain=3");
  EXPECT_EQ(s.agents[0].calibration, "ros2:/camera_info");
  EXPECT_THAT(error("agents: [{name: a, source: 'ros2:/image', start_s: auto}]"), HasSubstr("auto is for recordings"));
}

TEST(Source, IsShownWithoutPasswords) {
  EXPECT_EQ(shown_source("rtsp://guard:secret@10.0.0.2:554/stream?channel=1"),
            "rtsp://***@10.0.0.2:554/stream?channel=1");
  EXPECT_EQ(shown_source("rtsp://guard:se@cr/et@10.0.0.2/x"), "rtsp://***@10.0.0.2/x") << "not escaped";
  EXPECT_EQ(shown_source("http://10.0.0.2/shot.cgi?user=guard&pwd=secret&size=2"),
            "http://10.0.0.2/shot.cgi?user=guard&pwd=***&size=2");
  EXPECT_EQ(shown_source("gst:rtspsrc location=rtsp://a:b@cam/x user-pw=\"my secret\" ! decodebin"),
            "gst:rtspsrc location=rtsp://***@cam/x user-pw=*** ! decodebin");
  for (const char* as_it_is :
       {"rtsp://10.0.0.2:554/a@b", "v4l2:0?size=64x48", "ros2:/left?domain=3", "/data/a@b?pwd=c"})
    EXPECT_EQ(shown_source(as_it_is), as_it_is);
}

TEST_F(SequenceFile, TheScaleMayComeFromTags) {
  Sequence s = load("scale: {tag_m: 0.16}\n" + agent_);
  EXPECT_EQ(s.tag_m, 0.16);
  EXPECT_EQ(s.tag_family, "DICT_APRILTAG_36h11");
  EXPECT_FALSE(s.baseline_m);
  s = load("scale: {tag_m: 0.2, tag_family: DICT_4X4_50}\n" + agent_);
  EXPECT_EQ(s.tag_family, "DICT_4X4_50");
  EXPECT_THAT(error("scale: {tag_m: 0.2, baseline_m: 1}\n" + agent_),
              HasSubstr("scale.tag_m: give baseline_m or tag_m, not both"));
  EXPECT_THAT(error("scale: {tag_m: 0}\n" + agent_), HasSubstr("scale.tag_m: '0' is outside"));
  EXPECT_THAT(error("scale: {baseline_m: 1, tag_family: DICT_4X4_50}\n" + agent_),
              HasSubstr("tag_family: unknown key"));
}

TEST_F(SequenceFile, ErrorsNameFileLineKeyAndReason) {
  EXPECT_THAT(error("rate: 30\n" + agent_), HasSubstr("sequence.yaml:1: rate: unknown key, did you mean 'rate_hz'?"));
  EXPECT_THAT(error("colour: red\n" + agent_), HasSubstr("colour: unknown key, known are name rate_hz"));
  EXPECT_THAT(error(agent_ + "agnets: []\n"),
              HasSubstr("sequence.yaml:2: agnets: unknown key, did you mean 'agents'?"));
  EXPECT_THAT(error("agents:\n  - name: a\n    sorce: cam0.csv\n"),
              HasSubstr("sequence.yaml:3: agents[0].sorce: unknown key, did you mean 'source'?"));
  EXPECT_THAT(error("agents:\n  - name: a\n    calibration: calib.yaml\n"),
              HasSubstr("agents[0]: the key 'source' is missing"));
  EXPECT_THAT(error("agents: [{name: a, source: nothing, calibration: calib.yaml}]"),
              HasSubstr("agents[0].source: there is no " + (folder_ / "nothing").string()));
  EXPECT_THAT(error("rate_hz: fast\n" + agent_), HasSubstr("rate_hz: 'fast' is not a number"));
  EXPECT_THAT(error("rate_hz: -1\n" + agent_), HasSubstr("rate_hz: '-1' is outside 0.01 to 1000"));
  EXPECT_THAT(error("rate_hz: 30\nrate_hz: 20\n" + agent_),
              HasSubstr("sequence.yaml:2: rate_hz: the key stands twice"));
  EXPECT_THAT(error("scale: {}\n" + agent_), HasSubstr("scale: the key 'baseline_m' is missing"));
  EXPECT_THAT(error("scale: 1\n" + agent_), HasSubstr("scale: a section"));
  EXPECT_THAT(error("name: x\n"), HasSubstr("the key 'agents' is missing"));
  EXPECT_THAT(error("agents: []\n"), HasSubstr("agents: at least one agent"));
  EXPECT_THAT(error("agents: {}\n"), HasSubstr("agents: a list is expected"));
  EXPECT_THAT(error("agents: [\n"), HasSubstr("not valid YAML"));
  EXPECT_THAT(error("just text"), HasSubstr("a YAML map"));
  EXPECT_THAT(error(""), HasSubstr("a YAML map"));
}

TEST_F(SequenceFile, AgentNamesAreUniqueAndFitForFiles) {
  const auto named = [&](const std::string& name) {
    return error("agents: [{name: " + name + ", source: cam0.csv, calibration: calib.yaml}]");
  };
  EXPECT_THAT(named("a/b"), HasSubstr("agents[0].name: 'a/b' must be"));
  EXPECT_THAT(named(".."), HasSubstr("must be"));
  EXPECT_THAT(named(std::string(33, 'x')), HasSubstr("must be"));
  EXPECT_EQ(named("uav_1-left.b"), "");
  EXPECT_THAT(error("agents:\n- {name: a, source: cam0.csv, calibration: calib.yaml}\n"
                    "- {name: a, source: cam1.csv, calibration: calib.yaml}"),
              HasSubstr("agents[1].name: 'a' is the name of two agents"));
}

TEST_F(SequenceFile, MissingFiles) {
  EXPECT_THAT(test::error_of<UserError>([&] { load_sequence(folder_ / "no.yaml"); }), HasSubstr("no such sequence"));
  EXPECT_THAT(test::error_of<UserError>([&] { load_sequence(folder_ / "masks"); }), HasSubstr("has no sequence.yaml"));
}

class RigInSequence : public SequenceFile {
 protected:
  // Three agents, and these rigs.
  std::string with(const std::string& rigs) const {
    std::string agents = "agents:\n";
    for (const char* name : {"left", "right", "other"}) {
      agents += "  - {name: " + std::string(name) + ", source: \"v4l2:0\", calibration: calib.yaml}\n";
    }
    return agents + "rigs:\n  - " + rigs + "\n";
  }
};

TEST_F(RigInSequence, CamerasAreFixedToTheFirst) {
  const Sequence s = load(with("{cameras: [left, right], cam_from_first: {right: [-0.5, 0, 0, 0, 0, 0, 1]}}"));
  ASSERT_EQ(s.rigs.size(), 1U);
  EXPECT_EQ(s.rigs[0].camera, "right");
  EXPECT_EQ(s.rigs[0].first, "left");
  EXPECT_EQ(s.rigs[0].cam_from_first.translation, Eigen::Vector3d(-0.5, 0, 0));
}

TEST_F(RigInSequence, WhatIsWrongIsNamed) {
  const std::string right = "right: [-0.5, 0, 0, 0, 0, 0, 1]";
  EXPECT_THAT(error(with("{cameras: [left, rihgt], cam_from_first: {" + right + "}}")),
              HasSubstr("there is no agent 'rihgt'"));
  EXPECT_THAT(error(with("{cameras: [left], cam_from_first: {}}")), HasSubstr("a rig has at least two cameras"));
  EXPECT_THAT(error(with("{cameras: [left, right, other], cam_from_first: {" + right + "}}")),
              HasSubstr("the key 'other' is missing"));
  EXPECT_THAT(error(with("{cameras: [left, right], cam_from_first: {right: [-0.5, 0, 0]}}")),
              HasSubstr("seven numbers"));
  EXPECT_THAT(error(with("{cameras: [left, right, left], cam_from_first: {" + right + "}}")),
              HasSubstr("'left' is in two places"));
  EXPECT_THAT(error(with("{cameras: [left, right], cam_from_first: {" + right +
                         "}}\n  - {cameras: [other, right], "
                         "cam_from_first: {" +
                         right + "}}")),
              HasSubstr("'right' is in two places"));
  EXPECT_THAT(error("scale: {baseline_m: 1}\n" + with("{cameras: [left, right], cam_from_first: {" + right + "}}")),
              HasSubstr("rigs tell lengths: leave out scale"));
}

}  // namespace
}  // namespace coslam::sequence_test
