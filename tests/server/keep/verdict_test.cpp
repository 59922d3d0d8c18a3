// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/keep/verdict.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace coslam::verdict_test {
namespace {

using testing::HasSubstr;

TEST(Verdict, IsGoodWherePathLensAndImagesAre) {
  const Verdict verdict = verdict_of({.tracked_share = 0.97, .error_percent = 0.1, .focal_ratio = 1.02});
  EXPECT_EQ(verdict.quality, Quality::kGood);
  EXPECT_EQ(verdict.why, "");
}

TEST(Verdict, IsThatOfWhatIsWorst) {
  EXPECT_EQ(verdict_of({.tracked_share = 1, .error_percent = 0.5, .focal_ratio = {}}).quality, Quality::kFair);
  const Verdict poor = verdict_of({.tracked_share = 0.8, .error_percent = 2.5, .focal_ratio = 1.4});
  EXPECT_EQ(poor.quality, Quality::kPoor);
  EXPECT_THAT(poor.why, HasSubstr("open by 2.5 % of its length"));
}

TEST(Verdict, CountsImagesWithoutAPose) {
  EXPECT_EQ(verdict_of({.tracked_share = 0.8, .error_percent = 0.1, .focal_ratio = {}}).quality, Quality::kFair);
  const Verdict poor = verdict_of({.tracked_share = 0.34, .error_percent = 0.1, .focal_ratio = {}});
  EXPECT_EQ(poor.quality, Quality::kPoor);
  EXPECT_EQ(poor.why, "66 % of its images have no pose in the common map");
}

TEST(Verdict, IsNeverGoodThroughTheLensOfAnotherCamera) {
  const Verdict verdict = verdict_of({.tracked_share = 1, .error_percent = 0.1, .focal_ratio = 1.38});
  EXPECT_EQ(verdict.quality, Quality::kFair);
  EXPECT_THAT(verdict.why, HasSubstr("1.38 times"));
}

TEST(Verdict, IsPoorThroughALensThatIsHalfAsLongOrZooms) {
  EXPECT_EQ(verdict_of({.tracked_share = 1, .error_percent = 0.1, .focal_ratio = 0.58}).quality, Quality::kPoor);
  EXPECT_EQ(verdict_of({.tracked_share = 1, .error_percent = 0.1, .breathing = 0.01}).quality, Quality::kGood);
  const Verdict fair = verdict_of({.tracked_share = 1, .error_percent = 0.1, .breathing = 0.037});
  EXPECT_EQ(fair.quality, Quality::kFair);
  EXPECT_EQ(fair.why, "its focal length changes by up to 4 % from image to image");
  EXPECT_EQ(verdict_of({.tracked_share = 1, .error_percent = 0.1, .breathing = 0.1}).quality, Quality::kPoor);
}

TEST(Verdict, IsPoorWhereNothingTellsThePath) {
  EXPECT_EQ(verdict_of({.tracked_share = 1, .error_percent = {}, .focal_ratio = 1}).quality, Quality::kPoor);
  EXPECT_STREQ(name_of(Quality::kPoor), "poor");
}

}  // namespace
}  // namespace coslam::verdict_test
