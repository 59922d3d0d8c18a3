// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/solve/clock_offset.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace coslam::clock_offset_test {
namespace {

constexpr double kPrior_s = 0.02;

// Stretches of points that swing across the epipolar lines, with noise, a shift each, and some outliers.
std::vector<ClockStretch> stretches(int first, int second, const std::vector<double>& truth_s, double speed_px_s,
                                    int count, unsigned seed, double outliers = 0) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0, 1);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<ClockStretch> out;
  for (int k = 0; k < count; ++k) {
    ClockStretch& s = out.emplace_back(ClockStretch{first, second, 0.35, {}});
    const double shift_px = 0.4 * normal(random), phase = 6.28 * uniform(random);
    for (int i = 0; i < 16; ++i) {
      const double rate_px_s = speed_px_s * std::sin(phase + 0.2 * i);
      const double camera_px_s = 2 * normal(random);  // what the two cameras' own turning leaves
      const Eigen::Vector2d rates_px_s(rate_px_s, -rate_px_s + camera_px_s);
      const Eigen::Vector2d offsets_s(truth_s[static_cast<std::size_t>(first)],
                                      truth_s[static_cast<std::size_t>(second)]);
      const auto noise = [&](double sigma) -> Eigen::Vector2d {
        return {sigma * normal(random), sigma * normal(random)};
      };
      ClockObservation o{rates_px_s.dot(offsets_s) + shift_px + 0.3 * normal(random), rates_px_s + noise(5),
                         rates_px_s + noise(2)};
      if (uniform(random) < outliers) o.residual_px += 5 + 20 * uniform(random);
      s.seen.push_back(o);
    }
  }
  return out;
}

std::vector<ClockStretch> joined(std::vector<ClockStretch> a, const std::vector<ClockStretch>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

TEST(ClockOffsets, OfAllCamerasAgainstTheFirst) {
  for (const double half_frame_s : {1 / 60.0, -1 / 60.0, 0.0}) {
    const std::vector<double> truth_s{0, half_frame_s, 0.005};
    const auto all = joined(stretches(0, 1, truth_s, 60, 60, 1, 0.05), stretches(1, 2, truth_s, 60, 60, 2, 0.05));
    const auto offsets = solve_clock_offsets(3, all, kPrior_s);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(offsets[i].offset_s, truth_s[i], 0.002);
      EXPECT_NEAR(offsets[i].offset_s, truth_s[i], 3 * offsets[i].sigma_s + 1e-9);
      EXPECT_LT(offsets[i].sigma_s, 0.002);
    }
  }
}

TEST(ClockOffsets, TheSigmaCoversTheError) {
  int within = 0;
  constexpr int kRuns = 50;
  for (unsigned seed = 0; seed < kRuns; ++seed) {
    const auto offsets = solve_clock_offsets(2, stretches(0, 1, {0, 0.01}, 30, 20, seed), kPrior_s);
    within += std::abs(offsets[1].offset_s - 0.01) < 2 * offsets[1].sigma_s;
  }
  EXPECT_GE(within, kRuns * 9 / 10);
}

TEST(ClockOffsets, StillPointsSayNothing) {
  const auto offsets = solve_clock_offsets(2, stretches(0, 1, {0, 0.01}, 0, 100, 1), kPrior_s);
  EXPECT_EQ(offsets[0].sigma_s, 0);
  EXPECT_GT(offsets[1].sigma_s, 0.005);
}

TEST(ClockOffsets, WhatSharesNothingWithTheFirstHasItsOwnReference) {
  const std::vector<double> truth_s{0, 0.003, 0.003, 0.013};
  const auto offsets = solve_clock_offsets(4, stretches(2, 3, truth_s, 60, 60, 1), kPrior_s);
  EXPECT_EQ(offsets[1].sigma_s, kPrior_s);
  EXPECT_EQ(offsets[2].offset_s, 0);
  EXPECT_EQ(offsets[2].sigma_s, 0);
  EXPECT_NEAR(offsets[3].offset_s, 0.01, 0.002);
}

TEST(ClockOffsets, WithoutAnythingSeenAreUnknown) {
  for (const ClockOffset& o : solve_clock_offsets(2, {}, kPrior_s)) {
    EXPECT_EQ(o.offset_s, 0);
    EXPECT_EQ(o.sigma_s, kPrior_s);
  }
}

}  // namespace
}  // namespace coslam::clock_offset_test
