// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/places/depth_ratio.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "tests/support/map_fit.h"
#include "tests/support/sim_map.h"

namespace coslam {
namespace {

std::vector<double> ratios(std::size_t n, double sigma, std::mt19937* random) {
  std::normal_distribution<double> noise(std::log(1.2), sigma);
  std::vector<double> out;
  for (std::size_t i = 0; i < n; ++i) out.push_back(noise(*random));
  return out;
}

TEST(DepthRatio, FewTellNothing) {
  std::mt19937 random(1);
  EXPECT_FALSE(depth_ratio(ratios(kLeastDepthRatios - 1, 0.01, &random)));
  EXPECT_TRUE(depth_ratio(ratios(kLeastDepthRatios, 0.01, &random)));
}

TEST(DepthRatio, ThoseThatDisagreeTellNothing) {
  std::mt19937 random(1);
  EXPECT_FALSE(depth_ratio(ratios(200, 0.5, &random)));
}

TEST(DepthRatio, TheMedianIsAsFarOffAsItSays) {
  std::mt19937 random(1);
  constexpr int kTimes = 500;
  double squares = 0, said = 0;
  for (int i = 0; i < kTimes; ++i) {
    const auto ratio = depth_ratio(ratios(60, 0.1, &random));
    ASSERT_TRUE(ratio);
    squares += std::pow(std::log(ratio->scale / 1.2), 2) / kTimes;
    said += ratio->log_sigma / kTimes;
  }
  EXPECT_NEAR(said / std::sqrt(squares), 1, 0.2);
}

TEST(DepthRatio, AnOutlierOfThreeDoesNotMoveIt) {
  std::mt19937 random(1);
  std::vector<double> some = ratios(60, 0.02, &random);
  for (std::size_t i = 0; i < some.size(); i += 6) some[i] = 2;
  const auto ratio = depth_ratio(some);
  ASSERT_TRUE(ratio);
  EXPECT_NEAR(ratio->scale, 1.2, 0.02);
}

// A camera that goes four metres and comes back to where it began, as the map says `missing_m` beside it.
class LikelyScaleTest : public testing::Test {
 protected:
  LikelyScaleTest() {
    for (int i = 0; i <= kLast; ++i) {
      sim_.ingest();
      sim_.place(test::cam(0), at(4.0 * std::sin(std::numbers::pi * i / kLast)));
    }
  }
  static Rigid3 at(double x_m) { return {Eigen::Quaterniond::Identity(), {-x_m, 0, 0}}; }
  double likely(double scale, double log_sigma, double missing_m) const {
    const LoopConstraint loop{test::cam(0), test::cam(0), SetId(kLast), SetId(0), at(missing_m), scale};
    return likely_scale(sim_.map, loop, log_sigma);
  }
  static constexpr int kLast = 40;
  const test::SimWorld world_{{}};
  test::SimMap sim_{world_, test::paths_side_by_side(1)};
};

TEST_F(LikelyScaleTest, WhereLittleIsMissingLittleScaleIs) { EXPECT_NEAR(likely(1.2, 0.05, 0.005), 1, 0.002); }

TEST_F(LikelyScaleTest, WhereMuchIsMissingDepthsAreBelieved) { EXPECT_NEAR(likely(1.2, 0.02, 0.4), 1.2, 0.005); }

TEST_F(LikelyScaleTest, DepthsThatAreSureAreBelieved) { EXPECT_NEAR(likely(1.02, 0.0001, 0.005), 1.02, 0.001); }

TEST_F(LikelyScaleTest, WhatDriftsEvenlyIsMetHalfWayWhereBothAreAsUnsure) {
  // 2 * 0.1 / 4
  EXPECT_NEAR(std::log(likely(1.2, 0.05, 0.1)), 0.5 * std::log(1.2), 1e-3);
}

}  // namespace
}  // namespace coslam
