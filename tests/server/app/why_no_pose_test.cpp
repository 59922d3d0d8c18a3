// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/app/why_no_pose.h"

#include <gmock/gmock.h>

namespace coslam::why_no_pose_test {
namespace {

using testing::HasSubstr;

class WhyNoPose : public testing::Test {
 protected:
  std::string why() const { return why_no_pose(images_, faults_, seen_); }
  ImageAccount images_;
  std::array<std::uint64_t, kImageFaults> faults_{};
  SeenWithoutPose seen_{.most_tracks = 200, .most_flow_px = 100, .longest_s = 10};
};

TEST_F(WhyNoPose, OfImagesThatTheServerHardlyGot) {
  EXPECT_EQ(why(), "gave no images");
  images_[ImageFate::kLate] = 300;
  EXPECT_EQ(why(), "has no pose: 300 of its 300 images are too late for their instant");
  images_[ImageFate::kLost] = 400;
  EXPECT_EQ(why(), "has no pose: 400 of its 700 images are lost on the way");
}

TEST_F(WhyNoPose, OfImagesThatWereNotBelieved) {
  images_[ImageFate::kLeftOut] = 299;
  images_[ImageFate::kWithoutPose] = 1;
  faults_[static_cast<std::size_t>(ImageFault::kFeatureless)] = 200;
  faults_[static_cast<std::size_t>(ImageFault::kRepeated)] = 99;
  EXPECT_THAT(why(), HasSubstr("299 of its 300 images are not believed: nothing is to be seen in them"));
}

TEST_F(WhyNoPose, OfImagesThatShowTooLittle) {
  images_[ImageFate::kWithoutPose] = 300;
  EXPECT_THAT(why(), HasSubstr("no parallax"));
  seen_.most_flow_px = 0.4;
  EXPECT_THAT(why(), HasSubstr("it did not move (what it sees moved by 0.4 px at most)"));
  seen_.most_tracks = 12;
  EXPECT_THAT(why(), HasSubstr("at most 12 corners could be followed"));
}

TEST_F(WhyNoPose, OfFewImages) {
  images_[ImageFate::kWithoutPose] = 9;
  seen_.most_flow_px = 8;
  seen_.longest_s = 0.3;
  EXPECT_THAT(why(), HasSubstr("9 images over 0.3 s are too few"));
}

TEST_F(WhyNoPose, OfARecordingThatCameLate) {
  EXPECT_EQ(late_images("cam1", 236, 300, to_ns(7.44)),
            "236 of 300 images of cam1 lie before the 7.4 s that the map server had reached: start agents that belong "
            "together within 3 s of each other, or name all of them to the server (--set agents=NAME,NAME)");
}

}  // namespace
}  // namespace coslam::why_no_pose_test
