// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/solve/lag.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace coslam::lag_test {
namespace {

using Where = std::function<Eigen::Vector3d(double)>;  // of a body, by time

// Walks to and fro, and up and down with each step.
Eigen::Vector3d walker(double t_s) {
  return {1.5 * std::sin(0.5 * t_s) + 0.3 * std::sin(1.7 * t_s), 0.1 * std::sin(9 * t_s) + 0.4 * std::sin(0.9 * t_s),
          6 + std::cos(0.7 * t_s)};
}

// Images of a camera that drifts, dated `early_s` too early, of a body of 40 corners, of which others are followed each
// second.
std::vector<MovingSight> sights(const Where& body, const Eigen::Vector3d& camera, double rate_hz, double early_s,
                                double seconds, unsigned seed, double noise_rad = 0.0005) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0, 1);
  std::vector<Eigen::Vector3d> corners(40);
  for (auto& c : corners) c = 0.4 * Eigen::Vector3d(normal(random), normal(random), normal(random));
  std::vector<MovingSight> out;
  for (int i = 0; i < static_cast<int>(seconds * rate_hz); ++i) {
    const double t_s = i / rate_hz;
    MovingSight s{to_ns(t_s - early_s), camera + Eigen::Vector3d(0.1 * t_s, 0, 0), {}};
    for (std::uint64_t k = 0; k < 12; ++k) {
      const std::uint64_t second = static_cast<std::uint64_t>(t_s);
      const Eigen::Vector3d& corner = corners[(7 * k + 13 * second + seed) % corners.size()];
      const Eigen::Vector3d noise = noise_rad * Eigen::Vector3d(normal(random), normal(random), normal(random));
      s.rays.push_back(
          {TrackId(100 * second + k + 1), ((body(t_s) + corner - s.center).normalized() + noise).normalized()});
    }
    out.push_back(std::move(s));
  }
  return out;
}

std::optional<double> found_s(std::span<const MovingSight> first, std::span<const MovingSight> second) {
  std::vector<LagAgreement> lags;
  for (int i = -40; i <= 40; ++i) lags.push_back(lag_agreement(first, second, 0.05 * i));
  return best_lag_s(lags);
}

const Eigen::Vector3d kLeft(-1.5, 0, 0), kRight(1.5, 0.3, 0.5);

TEST(Lag, OfVideosThatDidNotStartTogetherIsFound) {
  const auto first = sights(walker, kLeft, 30, 0, 20, 1);
  for (const double early_s : {0.5, -0.5, 1.3, 0.0}) {
    for (const double rate_hz : {30.0, 10.0}) {
      const auto lag_s = found_s(first, sights(walker, kRight, rate_hz, early_s, 20, 2));
      ASSERT_TRUE(lag_s) << early_s << " s at " << rate_hz << " Hz";
      EXPECT_NEAR(*lag_s, early_s, 0.06) << rate_hz;
    }
  }
}

TEST(Lag, DifferentThingsTellNone) {
  const auto other = [](double t_s) {
    return Eigen::Vector3d(std::cos(0.8 * t_s), 0.5 * std::sin(1.3 * t_s + 1), 5 + 0.5 * std::sin(0.37 * t_s));
  };
  EXPECT_FALSE(found_s(sights(walker, kLeft, 30, 0, 20, 1), sights(other, kRight, 30, 0, 20, 2)));
}

TEST(Lag, WhatMovesEvenlyTellsNone) {
  const auto even = [](double t_s) { return Eigen::Vector3d(-2 + 0.2 * t_s, 0.1 * t_s, 6); };
  EXPECT_FALSE(found_s(sights(even, kLeft, 30, 0, 20, 1, 0), sights(even, kRight, 30, 0.5, 20, 2, 0)));
}

TEST(Lag, AShortLookTellsNone) {
  EXPECT_FALSE(found_s(sights(walker, kLeft, 30, 0, 2, 1), sights(walker, kRight, 30, 0.5, 2, 2)));
  EXPECT_FALSE(found_s({}, {}));
  EXPECT_FALSE(best_lag_s({}));
}

TEST(Lag, TheyAgreeMostAtTheLagAndLessBothWays) {
  const auto first = sights(walker, kLeft, 30, 0, 20, 1), second = sights(walker, kRight, 30, 0.5, 20, 2);
  const LagAgreement at = lag_agreement(first, second, 0.5);
  EXPECT_GT(at.agreement, 0.5 * at.instants);
  EXPECT_LT(lag_agreement(first, second, 0.4).agreement, 0.7 * at.agreement);
  EXPECT_LT(lag_agreement(first, second, 0.6).agreement, 0.7 * at.agreement);
}

}  // namespace
}  // namespace coslam::lag_test
