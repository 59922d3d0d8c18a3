// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/simulation/motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

namespace coslam::sim::motion_test {
namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;

// Largest jump of the second derivative between neighbouring samples.
double largest_kink(const std::function<double(double)>& f, double from, double to, double step) {
  double worst = 0, last = NAN;
  for (double t = from; t <= to; t += step) {
    const double second = (f(t + step) - 2 * f(t) + f(t - step)) / (step * step);
    if (!std::isnan(last)) worst = std::max(worst, std::abs(second - last));
    last = second;
  }
  return worst;
}

std::vector<ViewPose> square() {
  return {{{1, 0, 1}, 0, 0, 0}, {{0, 1, 1.2}, 30, 5, 0}, {{-1, 0, 1}, 10, -5, 2}, {{0, -1, 0.8}, -20, 0, -2}};
}

TEST(ViewPose, LooksAlongItsHeadingWithItsHeadUp) {
  const ViewPose view{{1, 2, 3}, 90, 0, 0};  // towards +y
  const Rigid3 pose = cam_from_world(view);
  EXPECT_NEAR((pose.center() - view.position_m).norm(), 0, 1e-12);
  EXPECT_NEAR((pose * Eigen::Vector3d(1, 7, 3) - Eigen::Vector3d(0, 0, 5)).norm(), 0, 1e-12);
  EXPECT_NEAR((pose * Eigen::Vector3d(2, 7, 3) - Eigen::Vector3d(1, 0, 5)).norm(), 0, 1e-12);   // +x to the right
  EXPECT_NEAR((pose * Eigen::Vector3d(1, 7, 4) - Eigen::Vector3d(0, -1, 5)).norm(), 0, 1e-12);  // up is -y
}

TEST(ViewPose, PitchIsUp) {
  const Rigid3 pose = cam_from_world({{0, 0, 0}, 0, 30, 0});
  const Eigen::Vector3d forward = pose.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  EXPECT_NEAR(std::asin(forward.z()) * kDegPerRad, 30, 1e-9);
}

TEST(LoopPath, PassesItsWaypointsAndCloses) {
  const LoopPath path(square(), 8.0);
  for (int i = 0; i < 8; ++i) {
    const ViewPose expected = square()[static_cast<std::size_t>(i % 4)], got = path.at(2.0 * i);
    EXPECT_NEAR((got.position_m - expected.position_m).norm(), 0, 1e-9) << i;
    EXPECT_NEAR(got.heading_deg, expected.heading_deg, 1e-9) << i;
    EXPECT_NEAR(got.pitch_deg, expected.pitch_deg, 1e-9) << i;
  }
}

TEST(ThereAndBack, RestsAtBothEnds) {
  const LoopPath path = there_and_back(square(), 2.0);
  EXPECT_NEAR((path.at(6).position_m - square()[3].position_m).norm(), 0, 1e-9);
  for (const double end_s : {0.0, 6.0}) {
    EXPECT_NEAR((path.at(end_s + 1e-4).position_m - path.at(end_s).position_m).norm() / 1e-4, 0, 1e-3);
    EXPECT_NEAR((path.at(end_s + 1).position_m - path.at(end_s - 1).position_m).norm(), 0, 1e-9);
  }
}

TEST(ViewPath, GoesAsFarAsItIsAsked) {
  const ViewPath path(square(), 0);
  for (double d = 0; d < 2 * path.length_m(); d += 0.1) {
    EXPECT_NEAR((path.at(d + 0.01).position_m - path.at(d).position_m).norm(), 0.01, 1e-4) << d;
  }
  EXPECT_NEAR((path.at(path.length_m()).position_m - path.at(0).position_m).norm(), 0, 1e-9);
}

TEST(ViewPath, TurnsOnWithEveryRound) {
  std::vector<ViewPose> round;
  for (int i = 0; i < 12; ++i) {
    const double angle = i * std::numbers::pi / 6;
    round.push_back({{3 * std::cos(angle), 3 * std::sin(angle), 1}, 30.0 * i + 90, 0, 0});
  }
  const ViewPath path(round, 360);
  EXPECT_NEAR(path.length_m(), 2 * std::numbers::pi * 3, 0.05);
  for (const double share : {0.0, 0.3, 0.99, 1.01, 1.7}) {
    EXPECT_NEAR(path.at(share * path.length_m()).heading_deg, 90 + 360 * share, 0.2) << share;
  }
}

TEST(EasedJourney, EndsAtRest) {
  EXPECT_EQ(eased_journey(0, 20, 0.5), 0);
  EXPECT_NEAR(eased_journey(20, 20, 0.5), 19, 1e-9);
  EXPECT_NEAR(eased_journey(25, 20, 0.5), 19, 1e-9);
  EXPECT_NEAR(eased_journey(11, 20, 0.5) - eased_journey(10, 20, 0.5), 1, 1e-9);
  EXPECT_LT(largest_kink([](double t) { return eased_journey(t, 20, 0.5); }, 0.01, 19.9, 1e-3), 0.05);
}

TEST(LoopPath, HasAContinuousSecondDerivative) {
  const LoopPath path(square(), 8.0);
  EXPECT_LT(largest_kink([&](double t) { return path.at(t).position_m.x(); }, -3, 12, 1e-3), 0.01);
  EXPECT_LT(largest_kink([&](double t) { return path.at(t).heading_deg; }, -3, 12, 1e-3), 0.5);
}

TEST(EasedStart, RisesFromRestToUnitSpeed) {
  EXPECT_EQ(eased_start(-1, 0.5), 0);
  EXPECT_LT(eased_start(0.05, 0.5), 1e-3);
  EXPECT_NEAR(eased_start(3.5, 0.5) - eased_start(2.5, 0.5), 1, 1e-12);
  EXPECT_LT(largest_kink([](double t) { return eased_start(t, 0.5); }, -0.5, 2, 1e-3), 0.02);
}

TEST(EasedStep, GoesFromZeroToOneWithBoundedSpeed) {
  EXPECT_EQ(eased_step(1.9, 2, 5), 0);
  EXPECT_EQ(eased_step(5.1, 2, 5), 1);
  EXPECT_NEAR(eased_step(3.5, 2, 5), 0.5, 1e-12);
  double fastest = 0;
  for (double t = 1.5; t < 5.5; t += 1e-3)
    fastest = std::max(fastest, (eased_step(t + 1e-3, 2, 5) - eased_step(t, 2, 5)) / 1e-3);
  EXPECT_NEAR(fastest, 1 / 3.0 / 0.75, 1e-3);
  EXPECT_LT(largest_kink([](double t) { return eased_step(t, 2, 5); }, 1, 6, 1e-3), 0.02);
}

TEST(PausedTime, StandsStillInBetween) {
  EXPECT_NEAR(paused_time(1, 6, 8, 0.5), 1, 1e-12);
  EXPECT_NEAR(paused_time(8, 6, 8, 0.5) - paused_time(6, 6, 8, 0.5), 0, 1e-12);
  EXPECT_NEAR(paused_time(10, 6, 8, 0.5) - paused_time(9, 6, 8, 0.5), 1, 1e-12);
}

TEST(HandShake, HasTheStatedSizeAndIsDifferentForEverySeed) {
  const HandShake shake(7, 0.003, 0.2);
  double moved = 0, turned = 0;
  constexpr int kSamples = 6000;
  for (int i = 0; i < kSamples; ++i) {
    const Rigid3 pose = shake.at(0.01 * i);
    moved += pose.translation.squaredNorm() / 3;
    turned += so3_log(pose.rotation).squaredNorm() / 3;
  }
  EXPECT_NEAR(std::sqrt(moved / kSamples), 0.003, 0.001);
  EXPECT_NEAR(std::sqrt(turned / kSamples) * kDegPerRad, 0.2, 0.07);
  EXPECT_GT((HandShake(8, 0.003, 0.2).at(1).translation - shake.at(1).translation).norm(), 1e-5);
  EXPECT_EQ(HandShake(7, 0.003, 0.2).at(1).translation, shake.at(1).translation);
}

}  // namespace
}  // namespace coslam::sim::motion_test
