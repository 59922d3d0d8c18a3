// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/two_views.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

namespace coslam::two_views_test {
namespace {

// Something with corners all over.
cv::Mat picture(cv::Size size, std::uint64_t seed) {
  cv::Mat coarse(size.height / 12, size.width / 12, CV_8UC1), fine;
  cv::RNG random(seed);
  random.fill(coarse, cv::RNG::UNIFORM, 20, 230);
  cv::resize(coarse, fine, size, 0, 0, cv::INTER_CUBIC);
  return fine;
}

TEST(TwoViews, AreToldByWhatBothHalvesShow) {
  const cv::Mat scene = picture({760, 360}, 1);
  cv::Mat both;
  cv::hconcat(scene(cv::Rect(40, 0, 640, 360)), scene(cv::Rect(80, 0, 640, 360)), both);
  EXPECT_TRUE(shows_two_views(both));
  cv::Mat other_rows;
  cv::hconcat(scene(cv::Rect(40, 0, 640, 330)), scene(cv::Rect(80, 30, 640, 330)), other_rows);
  EXPECT_FALSE(shows_two_views(other_rows));
}

TEST(TwoViews, AreNotSeenInAPictureOfOneCamera) {
  EXPECT_FALSE(shows_two_views(picture({1280, 360}, 1))) << "wide";
  EXPECT_FALSE(shows_two_views(picture({640, 480}, 1))) << "too narrow for two";
  EXPECT_FALSE(shows_two_views(cv::Mat::zeros(360, 1280, CV_8UC1))) << "nothing to tell it by";
}

TEST(TwoViews, AreCutApartByItsWidth) { EXPECT_NE(how_to_split(1280).find("videocrop right=640"), std::string::npos); }

}  // namespace
}  // namespace coslam::two_views_test
