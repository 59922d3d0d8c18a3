// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/model/pose_covariance.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <random>

namespace coslam::pose_covariance_test {
namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;

// Of full rank or less, standard deviations from 1e-5 to 10.
Matrix6d random_covariance(std::mt19937& random, int rank) {
  std::normal_distribution<> normal;
  std::uniform_real_distribution<> exponent(-5, 1);
  const Eigen::MatrixXd a = Eigen::MatrixXd::NullaryExpr(6, rank, [&] { return normal(random); });
  Matrix6d m = a * a.transpose();
  Eigen::Matrix<double, 6, 1> scale;
  for (int i = 0; i < 6; ++i) scale[i] = std::pow(10, exponent(random)) / std::sqrt(m(i, i));
  return scale.asDiagonal() * m * scale.asDiagonal();
}

TEST(PoseCovariance, KeepsDeviationsAndIsPositive) {
  std::mt19937 random(1);
  for (int i = 0; i < 300; ++i) {
    const Matrix6d before = random_covariance(random, 1 + i % 8);
    const PoseCovariance after = quantised_pose_covariance(before);
    for (int k = 0; k < 6; ++k) EXPECT_NEAR(std::sqrt(after(k, k) / before(k, k)), 1, 0.03);
    EXPECT_EQ(after, after.transpose());
    const Eigen::Matrix<double, 6, 1> s = after.cast<double>().diagonal().cwiseSqrt().cwiseInverse();
    const Matrix6d correlations = s.asDiagonal() * after.cast<double>() * s.asDiagonal();
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix6d>(correlations).eigenvalues()[0], 0);
  }
}

TEST(PoseCovariance, TwiceIsOnce) {
  std::mt19937 random(2);
  for (int i = 0; i < 300; ++i) {
    const PoseCovariance once = quantised_pose_covariance(random_covariance(random, 1 + i % 8));
    EXPECT_EQ(quantised_pose_covariance(once.cast<double>()), once);
  }
}

TEST(PoseCovariance, NoneIsNone) {
  EXPECT_EQ(quantised_pose_covariance(Matrix6d::Zero()), PoseCovariance::Zero());
  Matrix6d odd = Matrix6d::Identity();
  odd(0, 0) = -1;
  odd(1, 1) = std::numeric_limits<double>::quiet_NaN();
  odd(2, 3) = odd(3, 2) = std::numeric_limits<double>::infinity();
  odd(4, 4) = 1e30;
  const PoseCovariance m = quantised_pose_covariance(odd);
  EXPECT_TRUE(m.allFinite());
  EXPECT_EQ(m(0, 0), 0);
  EXPECT_EQ(m(1, 1), 0);
  EXPECT_NEAR(m(2, 2), 1, 0.06);
  EXPECT_NEAR(std::sqrt(m(4, 4)), 17.96, 0.01) << "the most there is";
}

TEST(PoseCovariance, CodesThatNoMatrixHas) {
  PoseCovarianceCode code = code_of_pose_covariance(PoseCovariance::Identity());
  EXPECT_TRUE(is_valid(code));
  for (std::size_t i = 6; i < code.size(); ++i) {
    PoseCovarianceCode bad = code;
    bad[i] = 255;
    EXPECT_FALSE(is_valid(bad));
    bad[i] = 254;  // a correlation of 1: no rank
    EXPECT_FALSE(is_valid(bad));
    bad[i] = 253;
    EXPECT_TRUE(is_valid(bad));
  }
}

TEST(PoseCovariance, WhateverIsValidIsFinite) {
  std::mt19937 random(3);
  int valid = 0;
  for (int i = 0; i < 20000; ++i) {
    PoseCovarianceCode code;
    for (auto& c : code) c = static_cast<std::uint8_t>(random());
    for (std::size_t k = 6; k < code.size(); ++k) code[k] = static_cast<std::uint8_t>(127 + random() % 100 - 50);
    if (!is_valid(code)) continue;
    ++valid;
    const PoseCovariance m = decoded_pose_covariance(code);
    EXPECT_TRUE(m.allFinite());
    EXPECT_GE(m.diagonal().minCoeff(), 0);
  }
  EXPECT_GT(valid, 100);
}

}  // namespace
}  // namespace coslam::pose_covariance_test
