// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/fields.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace coslam {
namespace {

cv::Mat view(double shift_px) {
  cv::Mat coarse(20, 30, CV_8UC3), image;
  cv::RNG(3).fill(coarse, cv::RNG::UNIFORM, 20, 230);
  cv::resize(coarse, image, {240, 160}, 0, 0, cv::INTER_CUBIC);
  const cv::Mat move = (cv::Mat_<double>(2, 3) << 1, 0, shift_px, 0, 1, 0);
  cv::warpAffine(image, image, move, image.size(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return image;
}

// Odd rows are of a time at which everything was elsewhere.
cv::Mat interlaced(double shift_px) {
  cv::Mat image = view(0);
  const cv::Mat later = view(shift_px);
  for (int y = 1; y < image.rows; y += 2) later.row(y).copyTo(image.row(y));
  return image;
}

TEST(Fields, ArePartedWhileSomethingMoves) {
  EXPECT_FALSE(is_combed(view(0)));
  EXPECT_FALSE(is_combed(interlaced(0)));
  EXPECT_TRUE(is_combed(interlaced(4)));
}

TEST(Fields, OneIsLeft) {
  cv::Mat image = interlaced(6);
  keep_one_field(image);
  EXPECT_FALSE(is_combed(image));
  EXPECT_LT(cv::norm(image, view(0), cv::NORM_L1) / static_cast<double>(3 * image.total()), 2);
  EXPECT_EQ(cv::norm(image.row(10), view(0).row(10), cv::NORM_INF), 0);
}

}  // namespace
}  // namespace coslam
