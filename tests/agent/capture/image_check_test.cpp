// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/image_check.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace coslam::image_check_test {
namespace {

constexpr int kWidth = 320, kHeight = 240;
constexpr TimeNs kPeriod_ns = 50'000'000;

// Images of a camera that moves over a textured wall, with a sensor's noise.
class ImageCheckTest : public testing::Test {
 protected:
  ImageCheckTest() : wall_(2 * kHeight, 2 * kWidth, CV_8UC1) {
    cv::Mat coarse(60, 80, CV_8UC1);
    random_.fill(coarse, cv::RNG::UNIFORM, 20, 230);
    cv::resize(coarse, wall_, wall_.size(), 0, 0, cv::INTER_CUBIC);
  }
  cv::Mat seen(int at_px) {
    cv::Mat image = wall_(cv::Rect(at_px, at_px / 2, kWidth, kHeight)).clone();
    add_noise(image, 2);
    return image;
  }
  cv::Mat even(double grey, double noise) {
    cv::Mat image(kHeight, kWidth, CV_8UC1, cv::Scalar(grey));
    add_noise(image, noise);
    return image;
  }
  ImageFault check(const cv::Mat& grey, ImageFault known = ImageFault::kNone) {
    Image image{FrameId(frame_++), 0, grey};
    image.fault = known;
    return check_.check(image);
  }
  void add_noise(cv::Mat& image, double sigma) {
    cv::Mat noise(image.size(), CV_16SC1), sum;
    random_.fill(noise, cv::RNG::NORMAL, 0, sigma);
    cv::add(image, noise, image, cv::noArray(), CV_8U);
  }
  cv::RNG random_{7};
  cv::Mat wall_;
  ImageCheck check_;
  std::uint32_t frame_ = 0;
};

TEST_F(ImageCheckTest, BelievesACameraThatMovesAndOneThatStands) {
  for (int i = 0; i < 100; ++i) ASSERT_EQ(check(seen(i)), ImageFault::kNone) << i;
  for (int i = 0; i < 100; ++i) ASSERT_EQ(check(seen(100)), ImageFault::kNone) << "its noise is new each time";
}

TEST_F(ImageCheckTest, AnImageThatComesAgain) {
  const cv::Mat first = seen(0), second = seen(1), third = seen(2);
  EXPECT_EQ(check(first), ImageFault::kNone);
  EXPECT_EQ(check(second), ImageFault::kNone);
  EXPECT_EQ(check(second.clone()), ImageFault::kNone) << "once may be chance";
  EXPECT_EQ(check(second.clone()), ImageFault::kRepeated);
  EXPECT_EQ(check(second.clone()), ImageFault::kRepeated);
  EXPECT_EQ(check(third), ImageFault::kNone);
  EXPECT_EQ(check(first.clone()), ImageFault::kOutOfOrder);
  for (int i = 0; i < 40; ++i) EXPECT_EQ(check(seen(3 + i)), ImageFault::kNone);
  EXPECT_EQ(check(first.clone()), ImageFault::kNone) << "that is long ago: who knows";
}

TEST_F(ImageCheckTest, AStreamThatGivesEachImageOnceMore) {
  for (const int every : {2, 3}) {  // images are new but for every so manyth one
    check_ = {};
    cv::Mat last;
    int left_out = 0;
    for (int i = 0; i < 60; ++i) {
      const bool is_new = i % every != every - 1;
      if (is_new) last = seen(i);
      const ImageFault fault = check(last.clone());
      EXPECT_TRUE(!is_new || fault == ImageFault::kNone) << i;
      if (fault == ImageFault::kRepeated) ++left_out;
    }
    EXPECT_EQ(left_out, 60 / every - 3) << "three of them tell";
  }
}

TEST_F(ImageCheckTest, BuffersThatComeAgainAndAgain) {
  std::vector<cv::Mat> ring;
  for (int i = 0; i < 4; ++i) ring.push_back(seen(3 * i));
  for (const cv::Mat& image : ring) EXPECT_EQ(check(image), ImageFault::kNone);
  for (std::size_t i = 0; i < 20; ++i) EXPECT_EQ(check(ring[i % 4].clone()), ImageFault::kOutOfOrder) << i;
}

TEST_F(ImageCheckTest, AnImageThatIsInPartTheOneBefore) {
  cv::Mat before;
  for (int i = 0; i < 30; ++i) {
    cv::Mat image = seen(4 * i);
    const bool torn = i % 5 == 4;
    if (torn) before.rowRange(kHeight / 2, kHeight).copyTo(image.rowRange(kHeight / 2, kHeight));
    EXPECT_EQ(check(image), torn ? ImageFault::kConcealed : ImageFault::kNone) << i;
    before = image;
  }
}

TEST_F(ImageCheckTest, ARimThatIsAlwaysTheSameOrASkyThatIsWhiteIsNoTear) {
  for (int i = 0; i < 30; ++i) {
    cv::Mat image = seen(4 * i);
    wall_(cv::Rect(0, 0, kWidth, 60)).copyTo(image.rowRange(0, 60));
    if (i > 10) image.rowRange(120, 200).setTo(255);
    EXPECT_EQ(check(image), ImageFault::kNone) << i;
  }
}

TEST_F(ImageCheckTest, ARecordingThatIsPlayedBackAndForthIsSound) {
  std::vector<cv::Mat> images;
  for (int i = 0; i < 12; ++i) images.push_back(seen(3 * i));
  for (int turn = 0; turn < 4; ++turn) {
    for (int i = 0; i + 1 < 12; ++i)
      ASSERT_EQ(check(images[static_cast<std::size_t>(turn % 2 == 0 ? i : 11 - i)].clone()), ImageFault::kNone)
          << turn << " " << i;
  }
}

TEST_F(ImageCheckTest, OnePixelMakesAnotherImage) {
  const cv::Mat first = seen(0);
  cv::Mat second = first.clone();
  ++second.at<std::uint8_t>(kHeight - 1, kWidth - 1);
  EXPECT_EQ(check(first), ImageFault::kNone);
  EXPECT_NE(check(second), ImageFault::kRepeated);
}

TEST_F(ImageCheckTest, ACameraWithNoiseThatStandsAndFreezes) {
  for (int i = 0; i < 30; ++i) ASSERT_EQ(check(seen(40)), ImageFault::kNone);
  const cv::Mat frozen = seen(40);
  EXPECT_EQ(check(frozen), ImageFault::kNone);
  EXPECT_EQ(check(frozen.clone()), ImageFault::kNone) << "once may be chance";
  for (int i = 0; i < 50; ++i) ASSERT_EQ(check(frozen.clone()), ImageFault::kRepeated) << i;
  for (int i = 0; i < 30; ++i) ASSERT_EQ(check(seen(40)), ImageFault::kNone);
}

TEST_F(ImageCheckTest, ASimulatorThatStandsGivesTheSameImage) {
  const cv::Mat still = wall_(cv::Rect(0, 0, kWidth, kHeight)).clone();
  for (int i = 0; i < 50; ++i) ASSERT_EQ(check(still.clone()), ImageFault::kNone) << i;
}

TEST_F(ImageCheckTest, AVideoThatCodesWhatStandsAsTheSame) {
  // A key frame each second of 30 changes all of it a little; in between a person moves in a part of the picture.
  for (int i = 0; i < 40; ++i) check(seen(i));
  cv::Mat still = seen(40), image = still.clone();
  int left_out = 0;
  for (int i = 0; i < 300; ++i) {
    if (i % 30 == 0) still = seen(40);
    if (i % 3 == 0) {
      image = still.clone();
      image(cv::Rect(20 + i % 100, 60, 40, 90)).setTo(i % 200);
    }
    left_out += check(image.clone()) != ImageFault::kNone;
  }
  EXPECT_LE(left_out, 6) << "at first";
}

TEST_F(ImageCheckTest, RowsAtTheEndThatAreOneRow) {
  EXPECT_EQ(check(seen(0)), ImageFault::kNone);
  cv::Mat filled = seen(1), repeated = seen(2), little = seen(3);
  filled.rowRange(kHeight - 40, kHeight).setTo(128);
  for (int y = kHeight - 40; y < kHeight; ++y) repeated.row(kHeight - 41).copyTo(repeated.row(y));
  for (int y = kHeight - 8; y < kHeight; ++y) little.row(kHeight - 9).copyTo(little.row(y));
  EXPECT_EQ(check(filled), ImageFault::kCutOff);
  EXPECT_EQ(check(repeated), ImageFault::kCutOff);
  EXPECT_EQ(check(little), ImageFault::kNone) << "a few rows do not matter";
}

TEST_F(ImageCheckTest, ARimThatIsAlwaysThereIsNone) {
  for (int i = 0; i < 20; ++i) {
    cv::Mat rimmed = seen(i);
    rimmed.rowRange(kHeight - 40, kHeight).setTo(64);
    ASSERT_EQ(check(rimmed), ImageFault::kNone);
  }
}

TEST_F(ImageCheckTest, APlainFloorOfASimulatorIsAFloor) {
  ASSERT_EQ(check(wall_(cv::Rect(0, 0, kWidth, kHeight)).clone()), ImageFault::kNone);
  cv::Mat floor = wall_(cv::Rect(1, 0, kWidth, kHeight)).clone();
  floor.rowRange(kHeight / 2, kHeight).setTo(90);
  floor.rowRange(0, kHeight / 4).setTo(200);  // and a plain sky
  EXPECT_EQ(check(floor), ImageFault::kNone);
}

TEST_F(ImageCheckTest, AFloorInTheDarkIsBlackByNature) {
  ASSERT_EQ(check(seen(0)), ImageFault::kNone);
  cv::Mat dark = seen(1);
  dark.rowRange(kHeight / 2, kHeight).setTo(0);
  EXPECT_EQ(check(dark), ImageFault::kNone);
}

TEST_F(ImageCheckTest, NothingIsToBeSeen) {
  EXPECT_EQ(check(even(4, 2.5)), ImageFault::kFeatureless) << "dark";
  EXPECT_EQ(check(even(255, 0)), ImageFault::kFeatureless) << "dazzled";
  cv::Mat night = even(4, 2.5);
  for (int i = 0; i < 20; ++i) night(cv::Rect(12 * i + 8, 8 * (i % 9) + 16, 10, 10)).setTo(180);
  EXPECT_EQ(check(night), ImageFault::kNone) << "a few lights can be followed";
  EXPECT_EQ(check(even(120, 4)), ImageFault::kFeatureless) << "covered by paper";
  EXPECT_EQ(check(even(128, 60)), ImageFault::kFeatureless) << "the snow of no signal";
  cv::Mat dim;
  seen(0).convertTo(dim, CV_8U, 0.1, 4);
  EXPECT_EQ(check(dim), ImageFault::kNone) << "a tenth of the contrast is enough";
}

TEST_F(ImageCheckTest, WhatTheSourceKnowsStands) {
  EXPECT_EQ(check({}, ImageFault::kUnreadable), ImageFault::kUnreadable);
  EXPECT_EQ(check(seen(0), ImageFault::kConcealed), ImageFault::kConcealed);
}

class ImageVerdictTest : public testing::Test {
 protected:
  // The verdict after so many.
  ImageFault note(ImageFault fault, int images = 1) {
    for (int i = 0; i < images; ++i) verdict_.note(fault, t_ns_ += kPeriod_ns);
    return verdict_.verdict();
  }
  ImageVerdict verdict_;
  TimeNs t_ns_ = 0;
};

TEST_F(ImageVerdictTest, ComesAfterAFifthOfASecondAndGoesAtOnce) {
  EXPECT_EQ(note(ImageFault::kNone, 20), ImageFault::kNone);
  EXPECT_EQ(note(ImageFault::kRepeated, 3), ImageFault::kNone);
  EXPECT_EQ(note(ImageFault::kRepeated), ImageFault::kRepeated);
  EXPECT_EQ(note(ImageFault::kFeatureless), ImageFault::kRepeated) << "the first reason stays";
  EXPECT_EQ(note(ImageFault::kNone), ImageFault::kNone);
}

TEST_F(ImageVerdictTest, PatienceIsThatOfTheCamera) {
  for (int i = 0; i < 10; ++i) {
    t_ns_ += 1'000'000'000;  // one image a second
    ASSERT_EQ(note(ImageFault::kNone), ImageFault::kNone);
  }
  t_ns_ += 2'000'000'000;
  EXPECT_EQ(note(ImageFault::kUnreadable), ImageFault::kNone);
  t_ns_ += 600'000'000;
  EXPECT_EQ(note(ImageFault::kMissing), ImageFault::kMissing);
}

TEST_F(ImageVerdictTest, ATimeThatGoesBackBeginsAnew) {
  note(ImageFault::kNone, 20);
  t_ns_ = -5'000'000'000;
  EXPECT_EQ(note(ImageFault::kNone), ImageFault::kNone);
  EXPECT_EQ(note(ImageFault::kRepeated, 3), ImageFault::kNone);
  EXPECT_EQ(note(ImageFault::kRepeated), ImageFault::kRepeated);
}

TEST_F(ImageVerdictTest, EachImageTwiceIsSound) {
  for (int i = 0; i < 40; ++i) {
    ASSERT_EQ(note(ImageFault::kNone), ImageFault::kNone);
    ASSERT_EQ(note(ImageFault::kRepeated), ImageFault::kNone);
  }
}

TEST_F(ImageVerdictTest, ManyDamagedOnesInASecond) {
  note(ImageFault::kNone, 20);
  for (int i = 0; i < 10; ++i) {
    note(ImageFault::kNone, 2);
    note(ImageFault::kOutOfOrder);
  }
  EXPECT_EQ(verdict_.verdict(), ImageFault::kOutOfOrder) << "those in between are doubted, too";
  EXPECT_EQ(note(ImageFault::kNone, 20), ImageFault::kNone) << "a second later";
}

TEST_F(ImageVerdictTest, OneDamagedImageIsOnlyLeftOut) {
  note(ImageFault::kNone, 20);
  EXPECT_EQ(note(ImageFault::kConcealed), ImageFault::kNone);
  EXPECT_EQ(note(ImageFault::kNone), ImageFault::kNone);
}

TEST_F(ImageVerdictTest, ACameraThatNeverGaveAGoodImage) {
  EXPECT_EQ(note(ImageFault::kFeatureless), ImageFault::kNone);
  EXPECT_EQ(note(ImageFault::kFeatureless, 4), ImageFault::kFeatureless);
}

}  // namespace
}  // namespace coslam::image_check_test
