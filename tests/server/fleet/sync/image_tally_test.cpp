// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/sync/image_tally.h"

#include <gtest/gtest.h>

namespace coslam::image_tally_test {
namespace {

AgentStatus said(std::uint32_t sent, std::uint32_t not_sent, std::uint32_t left_out) {
  AgentStatus status;
  status.frames = sent;
  status.dropped = not_sent;
  status.left_out = left_out;
  return status;
}

// A source of 100 images, and losses of each kind on the way from it to the map.
class ImageTallyTest : public testing::Test {
 protected:
  static constexpr std::uint32_t kImages = 100, kLeftOut = 3, kNotSent = 5, kLost = 7, kLate = 11, kOutOfTime = 2,
                                 kSetLeftOut = 13, kUnposed = 17;
  static constexpr std::uint32_t kSent = kImages - kLeftOut - kNotSent;
  static constexpr std::uint32_t kPosed = kSent - kLost - kLate - kOutOfTime - kSetLeftOut - kUnposed;

  void play() {
    for (std::uint32_t i = 0; i < kSent - kLost; ++i) {
      tally_.arrived();
      if (i < kLate) {
        tally_.late();
      } else if (i < kLate + kOutOfTime) {
        tally_.out_of_time();
      } else if (i < kLate + kOutOfTime + kSetLeftOut) {
        tally_.set_left_out();
      } else {
        tally_.used(i >= kLate + kOutOfTime + kSetLeftOut + kUnposed);
      }
    }
    tally_.heard(said(kSent, kNotSent, kLeftOut));
  }
  static ImageAccount expected() {
    ImageAccount out;
    out[ImageFate::kTracked] = kPosed;
    out[ImageFate::kWithoutPose] = kUnposed;
    out[ImageFate::kLeftOut] = kLeftOut;
    out[ImageFate::kNotSent] = kNotSent;
    out[ImageFate::kLost] = kLost;
    out[ImageFate::kLate] = kLate;
    out[ImageFate::kOutOfTime] = kOutOfTime;
    out[ImageFate::kSetLeftOut] = kSetLeftOut;
    return out;
  }
  ImageTally tally_;
};

TEST_F(ImageTallyTest, EachImageHasOneFate) {
  tally_.begin(false);
  play();
  EXPECT_EQ(tally_.so_far(), expected());
  EXPECT_EQ(tally_.so_far().captured(), kImages);
  EXPECT_EQ(tally_.at_end(kPosed, 0), expected());
  const ImageAccount parted = tally_.at_end(kPosed - 4, 3);
  EXPECT_EQ(parted[ImageFate::kInOtherMaps], 3U);
  EXPECT_EQ(parted[ImageFate::kWithoutPose], kUnposed + 1) << "one lost its pose in the end";
  EXPECT_EQ(parted.captured(), kImages);
}

TEST_F(ImageTallyTest, AnAgentThatCameAgainGoesOn) {
  tally_.begin(false);
  play();
  tally_.begin(false);
  play();
  ImageAccount both = expected();
  both += expected();
  EXPECT_EQ(tally_.so_far(), both);
  EXPECT_EQ(tally_.at_end(2 * kPosed, 0).captured(), 2 * kImages);
}

TEST_F(ImageTallyTest, WhatAnAgentSentToAServerBeforeThisOneIsNotOfThisRun) {
  tally_.begin(true);
  tally_.heard(said(1000, 20, 3));
  tally_.arrived();
  tally_.used(true);
  tally_.heard(said(1001, 21, 3));
  EXPECT_EQ(tally_.so_far().captured(), 2U);
  EXPECT_EQ(tally_.so_far()[ImageFate::kNotSent], 1U);
}

TEST_F(ImageTallyTest, WhatIsUnderWayIsNotLost) {
  tally_.begin(false);
  for (int i = 0; i < 3; ++i) tally_.arrived();
  tally_.used(true);
  tally_.heard(said(3, 0, 0));
  EXPECT_EQ(tally_.so_far().captured(), 1U) << "of the others nothing is known yet";
  for (int i = 0; i < 30; ++i) {
    tally_.arrived();
    tally_.used(true);
  }
  EXPECT_EQ(tally_.so_far().captured(), 31U) << "the agent says how many it sent but once a second";
  const ImageAccount end = tally_.at_end(31, 0);
  EXPECT_EQ(end[ImageFate::kSetLeftOut], 2U) << "they waited until the end";
  EXPECT_EQ(end.captured(), 33U);
}

}  // namespace
}  // namespace coslam::image_tally_test
