// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/run/turning.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace coslam::turning_test {
namespace {

using Angle = std::function<double(double)>;  // rad, by time

// Somebody who looks round, now slowly and now fast.
double looks_round(double t_s) { return 0.5 * std::sin(1.1 * t_s) + 0.3 * std::sin(0.37 * t_s * t_s); }

// A camera that looks another way than its bearer and is dated so much too early, with noisy poses.
Trajectory path(const Angle& angle, double early_s, double look_rad, unsigned seed, double rate_hz = 20) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0, 0.002);
  Trajectory out;
  for (int i = 0; i < static_cast<int>(12 * rate_hz); ++i) {
    const double t_s = i / rate_hz;
    const Eigen::AngleAxisd turn(angle(t_s + early_s), Eigen::Vector3d(0.2, 1, 0.1).normalized());
    const Eigen::AngleAxisd look(look_rad, Eigen::Vector3d::UnitX()), noise(normal(random), Eigen::Vector3d::UnitZ());
    Rigid3 pose;
    pose.rotation = Eigen::Quaterniond(noise * look * turn);
    out.push_back({to_ns(t_s), pose});
  }
  return out;
}

TEST(LagByTurning, OfCamerasThatAreHeldTogetherIsFound) {
  for (const double early_s : {0.0, 0.7, -2.4}) {
    const auto lag_s = lag_by_turning_s(path(looks_round, 0, 0, 1), path(looks_round, early_s, 0.8, 2, 30));
    ASSERT_TRUE(lag_s) << early_s;
    EXPECT_NEAR(*lag_s, early_s, 0.03);
  }
}

TEST(LagByTurning, OfCamerasThatTurnOnTheirOwnIsNone) {
  const auto other = [](double t_s) { return 0.6 * std::sin(0.9 * t_s + 1) + 0.2 * std::sin(0.5 * t_s * t_s); };
  EXPECT_FALSE(lag_by_turning_s(path(looks_round, 0, 0, 1), path(other, 0, 0, 2)));
}

TEST(LagByTurning, OfWhatRepeatsItselfIsNone) {
  const auto to_and_fro = [](double t_s) { return 0.5 * std::sin(3 * t_s); };
  EXPECT_FALSE(lag_by_turning_s(path(to_and_fro, 0, 0, 1), path(to_and_fro, 0.3, 0, 2)));
}

TEST(LagByTurning, OfCamerasThatDoNotTurnOrHaveNoPosesIsNone) {
  const auto still = [](double) { return 0.0; };
  EXPECT_FALSE(lag_by_turning_s(path(still, 0, 0, 1), path(still, 0, 0, 2)));
  EXPECT_FALSE(lag_by_turning_s({}, path(looks_round, 0, 0, 2)));
}

}  // namespace
}  // namespace coslam::turning_test
