// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/fixed_pattern.h"

#include <gtest/gtest.h>

#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace coslam::fixed_pattern_test {
namespace {

class FixedPatternTest : public testing::Test {
 protected:
  FixedPatternTest() : wall_(400, 4000, CV_8UC1), dots_(240, 320, CV_8UC1, cv::Scalar(0)) {
    cv::Mat coarse(50, 500, CV_8UC1);
    cv::RNG random(7);
    random.fill(coarse, cv::RNG::UNIFORM, 20, 180);
    cv::resize(coarse, wall_, wall_.size(), 0, 0, cv::INTER_CUBIC);
    for (int i = 0; i < 400; ++i) cv::circle(dots_, {random.uniform(0, 320), random.uniform(0, 240)}, 1, 70, -1);
  }
  cv::Mat seen(int x_px) const { return wall_(cv::Rect({x_px, x_px / 30}, dots_.size())).clone(); }
  bool found_in(const std::function<cv::Mat(int)>& image) const {
    FixedPattern pattern;
    for (int i = 0; i < 90; ++i) {
      const cv::Mat grey = image(i);
      cv::Mat blocks;
      cv::resize(grey, blocks, grey.size() / 8, 0, 0, cv::INTER_AREA);
      pattern.note(grey, blocks);
    }
    return pattern.found();
  }
  cv::Mat wall_, dots_;
};

TEST_F(FixedPatternTest, DotsThatStayWhileTheRestMovesAreFound) {
  EXPECT_TRUE(found_in([&](int i) -> cv::Mat { return seen(20 * i) + dots_; }));
  EXPECT_FALSE(found_in([&](int i) { return seen(20 * i); }));
}

TEST_F(FixedPatternTest, BeforeACameraThatStandsNothingMoves) {
  EXPECT_FALSE(found_in([&](int) -> cv::Mat { return seen(0) + dots_; }));
  EXPECT_FALSE(found_in([&](int i) -> cv::Mat { return seen(0) * (0.3 + 0.02 * (i % 40)); }));
}

TEST_F(FixedPatternTest, WhatMovesWithTheCameraInOnePlaceIsNoPattern) {
  EXPECT_FALSE(found_in([&](int i) {
    cv::Mat image = seen(20 * i);
    const cv::Rect hood(0, 160, 320, 80);
    seen(0)(hood).copyTo(image(hood));
    return image;
  }));
}

}  // namespace
}  // namespace coslam::fixed_pattern_test
