// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/alternation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace coslam::alternation_test {
namespace {

class AlternationTest : public testing::Test {
 protected:
  AlternationTest() : wall_(240, 400, CV_8UC1) {
    cv::Mat coarse(30, 50, CV_8UC1);
    cv::RNG(7).fill(coarse, cv::RNG::UNIFORM, 20, 230);
    cv::resize(coarse, wall_, wall_.size(), 0, 0, cv::INTER_CUBIC);
  }
  cv::Mat seen(int i, double gain = 1, double offset = 0) const {
    cv::Mat out;
    wall_(cv::Rect(i, i / 2, 94, 60)).convertTo(out, CV_8U, gain, offset);
    return out;
  }
  // Which of the images are used.
  std::vector<bool> used(int count, const std::function<cv::Mat(int)>& image) {
    std::vector<bool> out;
    for (int i = 0; i < count; ++i) out.push_back(!alternation_.leaves_out(image(i), step_ ? step_(i) : 20));
    return out;
  }
  cv::Mat wall_;
  std::function<double(int)> step_;
  Alternation alternation_;
};

TEST_F(AlternationTest, WhatMovesHowFastEverIsUsedWhole) {
  for (const int speed : {0, 1, 3}) {
    for (const bool u : used(60, [&](int i) { return seen(speed * i); })) EXPECT_TRUE(u) << speed;
  }
}

TEST_F(AlternationTest, OfBracketedExposuresTheOneWithTheMostContrast) {
  for (const int settings : {2, 3}) {
    alternation_ = {};
    const auto u = used(60, [&](int i) { return seen(i, i % settings == 1 ? 1.0 : 0.2 * (1 + i % settings)); });
    for (int i = 20; i < 60; ++i) EXPECT_EQ(u[static_cast<std::size_t>(i)], i % settings == 1) << i;
  }
}

TEST_F(AlternationTest, WithoutTheLightThatComesInEverySecond) {
  const auto u = used(60, [&](int i) { return seen(i / 4, 0.8, i % 2 == 0 ? 25 : 0); });
  for (int i = 20; i < 60; ++i) EXPECT_EQ(u[static_cast<std::size_t>(i)], i % 2 == 1) << i;
}

TEST_F(AlternationTest, WithoutDotsThatChangeLittleButHowMuchNeighboursDiffer) {
  step_ = [](int i) { return 20 + 0.1 * i + (i % 2 == 0 ? 8 : 0); };
  const auto u = used(60, [&](int i) { return seen(i, 0.8, i % 2 == 0 ? 3 : 0); });
  for (int i = 20; i < 60; ++i) EXPECT_EQ(u[static_cast<std::size_t>(i)], i % 2 == 1) << i;
}

TEST_F(AlternationTest, OfManyExposuresADarkOneThatHasNearlyTheMostContrast) {
  const std::vector<double> gains{0.1, 0.25, 0.6, 1.4, 3, 6};
  for (const std::size_t settings : {4, 5, 6}) {
    alternation_ = {};
    const auto u = used(90, [&](int i) { return seen(i, gains[static_cast<std::size_t>(i) % settings]); });
    std::vector<int> uses(settings);
    for (std::size_t i = 30; i < 90; ++i) uses[i % settings] += u[i] ? 1 : 0;
    EXPECT_EQ(uses[3], 60 / static_cast<int>(settings)) << settings;
    EXPECT_EQ(std::count(uses.begin(), uses.end(), 0), settings - 1) << settings;
  }
}

TEST_F(AlternationTest, ExposuresThatAreLessThanAStopApartCanBeFollowed) {
  for (const bool u : used(60, [&](int i) { return seen(i / 4, 0.5 + 0.15 * (i % 5)); })) EXPECT_TRUE(u);
}

TEST_F(AlternationTest, WithoutDotsThoughTheyAreInTwoOfThree) {
  for (const int without : {0, 1, 2}) {
    alternation_ = {};
    step_ = [=](int i) { return 20 + (i % 3 == without ? 0 : 8); };
    const auto u = used(60, [&](int i) { return seen(i, 0.8, i % 3 == without ? 0 : 3); });
    for (int i = 20; i < 60; ++i) EXPECT_EQ(u[static_cast<std::size_t>(i)], i % 3 == without) << i;
  }
}

TEST_F(AlternationTest, WithoutDotsThatAreInEveryThird) {
  step_ = [](int i) { return 20 + 0.01 * i + 0.3 * (i % 4) + (i % 3 == 0 ? 8 : 0); };
  const auto u = used(90, [&](int i) { return seen(i, 0.8, i % 3 == 0 ? 3 : 0); });
  for (int i = 20; i < 90; ++i) EXPECT_EQ(u[static_cast<std::size_t>(i)], i % 3 != 0) << i;
}

TEST_F(AlternationTest, ACameraThatShakesIsUsedWhole) {
  for (const int period : {4, 5, 6}) {
    alternation_ = {};
    const auto shaken = [&](int i) { return seen(40 + static_cast<int>(20 * std::sin(2 * CV_PI * i / period))); };
    for (const bool u : used(60, shaken)) EXPECT_TRUE(u) << period;
  }
}

TEST_F(AlternationTest, FlickerIsNoSetting) {
  step_ = [](int i) { return 20 * (1 + 0.05 * (i % 3)); };
  for (const bool u : used(60, [&](int i) { return seen(i / 4, 1 + 0.05 * (i % 3)); })) EXPECT_TRUE(u);
}

TEST_F(AlternationTest, AnImageThatIsMissingTurnsNothingRound) {
  const auto u = used(80, [&](int i) { return seen(i, (i < 40 ? i : i + 1) % 2 == 1 ? 1.0 : 0.2); });
  for (int i = 20; i < 80; ++i) EXPECT_EQ(u[static_cast<std::size_t>(i)], (i < 40 ? i : i + 1) % 2 == 1) << i;
}

TEST_F(AlternationTest, EndsWhenAllAreTakenAtOneSetting) {
  const auto u = used(80, [&](int i) { return seen(i, i % 2 == 1 || i > 40 ? 1.0 : 0.2); });
  for (int i = 60; i < 80; ++i) EXPECT_TRUE(u[static_cast<std::size_t>(i)]) << i;
}

TEST_F(AlternationTest, NeverLeavesOutAllForLong) {
  // A lamp that beats with the camera: 3.3 images a period, which no count of settings describes.
  const auto beating =
      used(240, [&](int i) { return seen(i / 6, 0.35 + 0.65 * std::pow(std::sin(M_PI * i / 3.3), 2)); });
  // Three exposures, of which images are missing now and then.
  alternation_ = {};
  int taken = 0;
  const std::vector<double> gains{0.4, 0.9, 2};
  const auto bracketed = used(240, [&](int i) {
    taken += i % 17 == 16 ? 2 : 1;
    return seen(i / 6, gains[static_cast<std::size_t>(taken % 3)]);
  });
  for (const auto& u : {beating, bracketed}) {
    int out = 0, most_out = 0;
    for (const bool use : u) most_out = std::max(most_out, out = use ? 0 : out + 1);
    EXPECT_LE(most_out, 12);
    EXPECT_GT(std::count(u.begin(), u.end(), true), 60);
  }
}

}  // namespace
}  // namespace coslam::alternation_test
