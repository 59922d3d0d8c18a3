// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/robust.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace coslam::robust_test {
namespace {

TEST(Tukey, RhoIsFlatBeyondTheThreshold) {
  EXPECT_EQ(tukey_rho(0, 3), 0);
  EXPECT_DOUBLE_EQ(tukey_rho(3, 3), 1.5);
  EXPECT_DOUBLE_EQ(tukey_rho(-4, 3), 1.5);
  EXPECT_DOUBLE_EQ(tukey_rho(1e9, 3), 1.5);
  EXPECT_NEAR(tukey_rho(0.01, 3), 0.5e-4, 1e-8);  // a square near 0
}

TEST(Tukey, RhoIsSymmetricAndRises) {
  double last = 0;
  for (double x = 0.1; x < 3; x += 0.1) {
    EXPECT_GT(tukey_rho(x, 3), last);
    EXPECT_DOUBLE_EQ(tukey_rho(x, 3), tukey_rho(-x, 3));
    last = tukey_rho(x, 3);
  }
}

TEST(Tukey, WeightIsTheDerivativeOfRhoOverX) {
  constexpr double h = 1e-6;
  for (double x = 0.05; x < 4; x += 0.1) {
    const double slope = (tukey_rho(x + h, 3) - tukey_rho(x - h, 3)) / (2 * h);
    EXPECT_NEAR(tukey_weight(x, 3), slope / x, 1e-6) << x;
  }
  EXPECT_EQ(tukey_weight(0, 3), 1);
  EXPECT_EQ(tukey_weight(3.01, 3), 0);
}

std::vector<double> norms_of_gauss(int count, double sigma_px, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0, sigma_px);
  std::vector<double> norms;
  for (int i = 0; i < count; ++i) norms.push_back(std::hypot(normal(random), normal(random)));
  return norms;
}

TEST(UpperMedian, IsTheUpperOfTwo) {
  std::vector<double> none, odd{5, 1, 3}, even{4, 1, 3, 2};
  EXPECT_EQ(upper_median(none), 0);
  EXPECT_EQ(upper_median(odd), 3);
  EXPECT_EQ(upper_median(even), 3);
}

TEST(RobustSigma, IsThatOfOneAxis) {
  std::vector<double> norms = norms_of_gauss(20000, 0.7, 1);
  EXPECT_NEAR(robust_sigma_2d(norms), 0.7, 0.01);
}

TEST(RobustSigma, StandsAThirdOfOutliers) {
  std::vector<double> norms = norms_of_gauss(2000, 0.7, 2);
  norms.insert(norms.end(), 1000, 500.0);
  const double sigma_px = robust_sigma_2d(norms);
  EXPECT_GT(sigma_px, 0.6);
  EXPECT_LT(sigma_px, 1.2);  // biased by the share of outliers, not by their size
}

TEST(RobustSigma, FewValues) {
  std::vector<double> none, one{2.0};
  EXPECT_EQ(robust_sigma_2d(none), 0);
  EXPECT_NEAR(robust_sigma_2d(one), 2.0 / 1.17741, 1e-5);
}

}  // namespace
}  // namespace coslam::robust_test
