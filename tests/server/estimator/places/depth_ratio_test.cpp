// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/places/depth_ratio.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace coslam::depth_ratio_test {
namespace {

std::vector<double> ratios(std::size_t n, double sigma, std::mt19937* random) {
  std::normal_distribution<double> noise(std::log(1.2), sigma);
  std::vector<double> out;
  for (std::size_t i = 0; i < n; ++i) out.push_back(noise(*random));
  return out;
}

TEST(DepthRatio, FewTellNothing) {
  std::mt19937 random(1);
  EXPECT_FALSE(depth_ratio(ratios(kLeastPairs - 1, 0.01, &random)));
  EXPECT_TRUE(depth_ratio(ratios(kLeastPairs, 0.01, &random)));
}

TEST(DepthRatio, ThoseThatDisagreeTellNothing) {
  std::mt19937 random(1);
  EXPECT_FALSE(depth_ratio(ratios(200, 0.5, &random)));
}

TEST(DepthRatio, AnOutlierInSixDoesNotMoveIt) {
  std::mt19937 random(1);
  std::vector<double> some = ratios(60, 0.02, &random);
  for (std::size_t i = 0; i < some.size(); i += 6) some[i] = 2;
  const auto ratio = depth_ratio(some);
  ASSERT_TRUE(ratio);
  EXPECT_NEAR(*ratio, 1.2, 0.02);
}

}  // namespace
}  // namespace coslam::depth_ratio_test
