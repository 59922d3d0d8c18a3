// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/doctor/camera.h"

#include "tests/deploy/coslam/doctor/said.h"

namespace coslam::doctor::camera_test {
namespace {

using ::testing::Each;
using ::testing::Field;

SourceFacts well() {
  SourceFacts facts{.name = "v4l2:0", .live = true, .width_px = 640, .height_px = 480, .images = 60};
  facts.period_s = facts.longest_s = 1 / 30.0;
  facts.light = 110;
  facts.sharpness = 0.05;
  facts.behind_s = 0.002;
  facts.track_s = 0.005;
  facts.tracks = 290;
  facts.most_tracks = 300;
  return facts;
}

TEST(DoctorCamera, Devices) {
  EXPECT_THAT(first_of(judge(std::vector<VideoDevice>())), Says(Grade::kOk, "no /dev/video*", ""));
  EXPECT_THAT(first_of(judge(std::vector<VideoDevice>{{"/dev/video0", "Permission denied", true}})),
              Says(Grade::kFail, "may not open it", "usermod -aG video"));
  EXPECT_THAT(first_of(judge(std::vector<VideoDevice>{{"/dev/video0", "Device or resource busy"}})),
              Says(Grade::kWarn, "busy", "v4l2-ctl"));
  EXPECT_THAT(
      first_of(judge(std::vector<VideoDevice>{{"/dev/video0", "", false, "Webcam", {"MJPG up to 1920x1080", "YUYV"}}})),
      Says(Grade::kOk, "Webcam: MJPG up to 1920x1080, YUYV", ""));
}

TEST(DoctorCamera, SourceThatIsWell) { EXPECT_THAT(judge(well()), Each(Field(&Finding::grade, Grade::kOk))); }

TEST(DoctorCamera, SourceThatCannotBeRead) {
  SourceFacts facts;
  facts.problem = "there is no source 'x'";
  EXPECT_THAT(first_of(judge(facts)), Says(Grade::kFail, "there is no source 'x'", "docs/inputs.md"));
  facts.live = true;
  EXPECT_THAT(first_of(judge(facts)), Says(Grade::kFail, "there is no source 'x'", "v4l2-ctl"));
  facts = well();
  facts.images = 1;
  EXPECT_THAT(first_of(judge(facts)), Says(Grade::kFail, "1 in two seconds", "cable"));
}

TEST(DoctorCamera, CalibrationThatCannotBeRead) {
  SourceFacts facts = well();
  facts.doubt = "no calibration is given: the lens is guessed";
  facts.calibration_problem = "left.yaml: cannot be read: there is no such file";
  EXPECT_THAT(first_of(judge(facts)), Says(Grade::kFail, "left.yaml: cannot be read", "coslam calibrate makes one"));
}

TEST(DoctorCamera, Pictures) {
  SourceFacts facts = well();
  facts.fault = ImageFault::kFeatureless;
  facts.at_fault = 60;
  EXPECT_THAT(first_of(judge(facts)), Says(Grade::kFail, "nothing is to be seen", "docs/inputs.md"));
  facts.at_fault = 3;
  EXPECT_THAT(first_of(judge(facts)), Says(Grade::kWarn, "3 of 60 are left out", ""));
  facts = well();
  facts.light = 12;
  EXPECT_THAT(first_of(judge(facts)), Says(Grade::kWarn, "too dark", "light"));
  facts = well();
  facts.clipped = 0.6;
  EXPECT_THAT(first_of(judge(facts)), Says(Grade::kWarn, "60 % black or white", "exposure"));
  facts = well();
  facts.sharpness = 0.001;
  EXPECT_THAT(first_of(judge(facts)), Says(Grade::kWarn, "soft", "focus"));
}

TEST(DoctorCamera, PaceStampsAndTime) {
  SourceFacts facts = well();
  facts.longest_s = 0.5;
  EXPECT_THAT(first_of(judge(facts)), Says(Grade::kWarn, "once none for 500 ms", "port"));
  facts = well();
  facts.nominal_hz = 60;
  EXPECT_THAT(first_of(judge(facts)), Says(Grade::kWarn, "30 Hz instead of 60", "rate_hz: 30"));
  facts = well();
  facts.behind_s = -7;
  EXPECT_THAT(first_of(judge(facts)), Says(Grade::kWarn, "7 s ahead of", "chrony"));
  facts = well();
  facts.track_s = 0.05;
  EXPECT_THAT(first_of(judge(facts)), Says(Grade::kFail, "images will be dropped", "most_width_px"));
  facts.track_s = 0.028;
  EXPECT_THAT(first_of(judge(facts)), Says(Grade::kWarn, "little time", "max_tracks"));
  facts = well();
  facts.tracks = 10;
  EXPECT_THAT(first_of(judge(facts)), Says(Grade::kWarn, "hardly anything to follow", "texture"));
  facts = well();
  facts.doubt = "the focal length is odd";
  EXPECT_THAT(first_of(judge(facts)), Says(Grade::kWarn, "odd", "coslam calibrate"));
}

}  // namespace
}  // namespace coslam::doctor::camera_test
