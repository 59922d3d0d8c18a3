// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/levenberg_marquardt.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <vector>

namespace coslam::levenberg_marquardt_test {
namespace {

// Rosenbrock's valley as two residuals: 10 (y - x^2) and 1 - x. Its minimum is at (1, 1).
class Valley {
 public:
  Eigen::Vector2d at{-1.2, 1};
  std::vector<double> tried;

  double cost() const { return cost_at(at); }
  LmStep step(double lambda) {
    tried.push_back(lambda);
    Eigen::Matrix2d j;
    j << -20 * at.x(), 10, -1, 0;
    Eigen::Matrix2d h = j.transpose() * j;
    h.diagonal() *= 1 + lambda;
    const Eigen::Vector2d next = at - Eigen::Vector2d(h.ldlt().solve(j.transpose() * residuals(at)));
    if (!(cost_at(next) < cost())) return LmStep::kFailed;
    const bool settled = (next - at).norm() < 1e-10;
    at = next;
    return settled ? LmStep::kConverged : LmStep::kImproved;
  }

 private:
  static Eigen::Vector2d residuals(const Eigen::Vector2d& p) { return {10 * (p.y() - p.x() * p.x()), 1 - p.x()}; }
  static double cost_at(const Eigen::Vector2d& p) { return residuals(p).squaredNorm(); }
};

TEST(LevenbergMarquardt, FindsTheMinimumOfACurvedValley) {
  Valley valley;
  const int iterations = levenberg_marquardt({}, 100, [&](double lambda) { return valley.step(lambda); });
  EXPECT_LT((valley.at - Eigen::Vector2d(1, 1)).norm(), 1e-6);
  EXPECT_LT(iterations, 60);
}

TEST(LevenbergMarquardt, DampsMoreAfterAFailureAndLessAfterASuccess) {
  std::vector<double> tried;
  const std::vector<LmStep> outcomes{LmStep::kFailed, LmStep::kFailed, LmStep::kImproved, LmStep::kConverged};
  const int iterations = levenberg_marquardt({.first = 1e-3}, 100, [&](double lambda) {
    tried.push_back(lambda);
    return outcomes[tried.size() - 1];
  });
  ASSERT_EQ(tried.size(), 4U);
  EXPECT_DOUBLE_EQ(tried[1], 1e-2);
  EXPECT_DOUBLE_EQ(tried[2], 1e-1);
  EXPECT_NEAR(tried[3], 1e-2, 1e-12);
  EXPECT_EQ(iterations, 3) << "the step that ended it does not count";
}

TEST(LevenbergMarquardt, GivesUpWhenNothingHelps) {
  int steps = 0;
  const auto fails = [&](double) {
    ++steps;
    return LmStep::kFailed;
  };
  EXPECT_EQ(levenberg_marquardt({.first = 1e-4, .most = 1}, 100, fails), steps);
  EXPECT_LE(steps, 5);
}

TEST(LevenbergMarquardt, CountsFailuresOnlyWhereTheyAreIterations) {
  int steps = 0;
  const auto every_third_helps = [&](double) { return ++steps % 3 == 0 ? LmStep::kImproved : LmStep::kFailed; };
  EXPECT_EQ(levenberg_marquardt({.counts_failures = false}, 5, every_third_helps), 5);
  EXPECT_EQ(steps, 15);
}

TEST(LevenbergMarquardt, EndsAtEquationsWithoutASolution) {
  int steps = 0;
  const auto impossible = [&](double) {
    ++steps;
    return LmStep::kImpossible;
  };
  EXPECT_EQ(levenberg_marquardt({}, 10, impossible), 0);
  EXPECT_EQ(steps, 1);
}

}  // namespace
}  // namespace coslam::levenberg_marquardt_test
