// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/run/sources.h"

#include <gmock/gmock.h>

#include "common/base/error.h"
#include "tests/support/temp_folder.h"

namespace coslam::sources_test {
namespace {

using testing::HasSubstr;

struct Sources : testing::Test {
  static Sequence of(const std::vector<std::string>& texts) { return sequence_of_sources(texts); }
  static std::string error(const std::vector<std::string>& texts) {
    return test::error_of<UserError>([&] { of(texts); });
  }
  test::TempFolder folder_;
};

TEST_F(Sources, CamerasAtWorkAreNamedForWhatTellsThemApartAndHaveOneTime) {
  const Sequence s = of({"ros2:/left/image_raw", "ros2:/right/image_raw?domain=3", "v4l2:0?size=640x480",
                         "v4l2:/dev/video2", "rtsp://me:secret@10.0.0.4:554/stream1"});
  std::vector<std::string> names;
  for (const SequenceAgent& a : s.agents) {
    names.push_back(a.name);
    EXPECT_FALSE(a.start_is_open) << a.name;
  }
  EXPECT_THAT(names,
              testing::ElementsAre("left_image_raw", "right_image_raw", "0", "dev_video2", "10.0.0.4_554_stream1"));
  EXPECT_EQ(s.agents[1].source, "ros2:/right/image_raw?domain=3");
}

TEST_F(Sources, TopicsOfOneRecordingHaveItsClock) {
  const std::string walk = folder_.write("walk.bag", "").string(), other = folder_.write("other.bag", "").string();
  const Sequence s = of({"bag:" + walk + "#/cam0", "bag:" + walk + "#/cam1", "bag:" + other, other});
  EXPECT_EQ(s.agents[1].name, "cam1");
  EXPECT_EQ(s.agents[1].source, "bag:" + walk + "#/cam1");
  EXPECT_FALSE(s.agents[1].start_is_open);
  EXPECT_EQ(s.agents[2].name, "other");
  EXPECT_TRUE(s.agents[2].start_is_open);
  EXPECT_EQ(s.agents[3].name, "other-2");
}

TEST_F(Sources, ThatTwoAgentsShareIsSaid) {
  const std::string film = folder_.write("a.mp4", "").string(), other = folder_.write("b.mp4", "").string();
  EXPECT_EQ(shared_source(of({film, other}).agents), "");
  Sequence twice = of({film, film});
  EXPECT_EQ(shared_source(twice.agents), "a and a-2 play the same source, " + film + ", at the same time");
  twice.agents[1].start_is_open = false;
  twice.agents[1].start_s = 3;
  EXPECT_EQ(shared_source(twice.agents), "") << "two parts of one recording";
}

TEST_F(Sources, WhatIsNotThereIsNamed) {
  EXPECT_THAT(error({"bag:" + (folder_ / "none.mcap").string() + "#/cam0"}), HasSubstr("there is no"));
  const std::string film = folder_.write("a.mp4", "").string();
  EXPECT_THAT(error({film, (folder_ / "b.mp4").string()}), HasSubstr("b.mp4: there is no such file or folder"));
  EXPECT_THAT(error({film, folder_.write("s.yaml", "").string()}), HasSubstr("a sequence is given alone"));
}

TEST_F(Sources, ImagesOneByOneAreNoCameras) {
  const std::string a = folder_.write("0.jpg", "").string(), b = folder_.write("1.jpg", "").string();
  EXPECT_THAT(error({a, b}), HasSubstr("each of the 2 images would be a camera: name their folder, "));
}

}  // namespace
}  // namespace coslam::sources_test
