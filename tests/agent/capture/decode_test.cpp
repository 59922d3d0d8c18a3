// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/decode.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <set>

namespace coslam::decode_test {
namespace {

// Levels from `low` to `high`, as thermal and other deep sensors give them.
cv::Mat ramp(int low, int high) {
  cv::Mat out(120, 160, CV_16UC1);
  for (int y = 0; y < out.rows; ++y) {
    for (int x = 0; x < out.cols; ++x) {
      out.at<std::uint16_t>(y, x) = static_cast<std::uint16_t>(low + (high - low) * (y * out.cols + x) / out.total());
    }
  }
  return out;
}

TEST(DeepLevels, FewOfManyLevelsBecomeMany) {
  DeepLevels levels;
  EXPECT_FALSE(levels.limits());
  const cv::Mat grey = levels.spread(ramp(7800, 8400));
  ASSERT_EQ(grey.type(), CV_8UC1);
  const std::set<std::uint8_t> used(grey.begin<std::uint8_t>(), grey.end<std::uint8_t>());
  EXPECT_GT(used.size(), 200U) << "of 600, where 16384 would leave ten";
  EXPECT_GT(*used.begin(), 0);
  EXPECT_LT(*used.rbegin(), 255);
}

TEST(DeepLevels, NoiseIsNotSpreadToAnImage) {
  DeepLevels levels;
  cv::Mat dark(120, 160, CV_16UC1), grey;
  cv::randn(dark, 100, 3);
  grey = levels.spread(dark);
  cv::Scalar mean, deviation;
  cv::meanStdDev(grey, mean, deviation);
  EXPECT_LT(deviation[0], 12);
}

TEST(DeepLevels, AfterADarkFirstImageNothingIsWhite) {
  DeepLevels levels;
  levels.spread(ramp(90, 110));
  const cv::Mat grey = levels.spread(ramp(100, 4000));
  EXPECT_LT(cv::countNonZero(grey == 255), 0.05 * static_cast<double>(grey.total()));
}

TEST(DeepLevels, SomethingHotIsNotTheNewScale) {
  DeepLevels levels;
  const cv::Mat before = levels.spread(ramp(8000, 9000)).clone();
  cv::Mat hot = ramp(8000, 9000);
  hot(cv::Rect(0, 0, 20, 20)).setTo(16000);  // 2 % of the image
  const cv::Mat after = levels.spread(hot);
  EXPECT_NEAR(after.at<std::uint8_t>(60, 80), before.at<std::uint8_t>(60, 80), 40) << "a twentieth of the way";
  for (int i = 0; i < 100; ++i) levels.spread(hot);
  EXPECT_GT(levels.limits()->high, 15000) << "in the end it is one of the levels";
}

TEST(GreyReader, TakesWhatIsGreyAndSaysWhatItSpreads) {
  GreyReader reader;
  EXPECT_TRUE(reader.in_8_bits(cv::Mat(4, 4, CV_32FC1)).empty());
  EXPECT_EQ(reader.in_8_bits(cv::Mat(4, 4, CV_8UC1, cv::Scalar(7))).at<std::uint8_t>(0, 0), 7);
  EXPECT_TRUE(reader.bit_depth_note().empty());
  EXPECT_EQ(reader.in_8_bits(ramp(0, 65535)).type(), CV_8UC1);
  EXPECT_NE(reader.bit_depth_note().find("more than 8 bits"), std::string::npos);
}

}  // namespace
}  // namespace coslam::decode_test
