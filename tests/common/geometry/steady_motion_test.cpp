// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/steady_motion.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>
#include <vector>

#include "common/geometry/robust.h"
#include "tests/support/matchers.h"

namespace coslam::steady_motion_test {
namespace {

using test::PoseNear;

double median(std::vector<double> values) { return upper_median(values); }

constexpr double kStep_s = 1.0 / 30;

// A camera whose turn and way change by white acceleration of that density, in steps far below an image's.
class Walk {
 public:
  Walk(double turn_q, double way_q, unsigned seed) : random_(seed) {
    for (int i = 0; i < 6; ++i) density_[i] = std::sqrt(i < 3 ? turn_q : way_q);
    velocity_ << 0.1, -0.2, 0.05, 0.5, 0.1, -0.3;
  }
  const Rigid3& step() {
    constexpr int kFine = 20;
    for (int k = 0; k < kFine; ++k) {
      const double dt_s = kStep_s / kFine;
      for (int i = 0; i < 6; ++i) velocity_[i] += density_[i] * std::sqrt(dt_s) * normal_(random_);
      pose_ = retract(pose_, velocity_ * dt_s);
    }
    return pose_;
  }
  const Rigid3& pose() const { return pose_; }
  Vector6d noise(double turn, double way) {
    Vector6d out;
    for (int i = 0; i < 6; ++i) out[i] = (i < 3 ? turn : way) * normal_(random_);
    return out;
  }

 private:
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  Vector6d density_, velocity_;
  Rigid3 pose_;
};

constexpr double kTurnQ = 0.02, kWayQ = 0.1;

// Follows a walk for two seconds by exact poses.
SteadyMotion learned(Walk* walk) {
  SteadyMotion motion;
  for (int i = 0; i < 60; ++i) {
    const Rigid3 last = walk->pose();
    motion.follow(last, walk->step(), Matrix6d::Zero(), kStep_s, true);
  }
  return motion;
}

TEST(SteadyMotion, SaysNothingBeforeItWasSeenForAWhile) {
  Walk walk(kTurnQ, kWayQ, 1);
  SteadyMotion motion;
  EXPECT_FALSE(motion.predict(walk.pose(), kStep_s));
  for (int i = 0; i < 3; ++i) {
    const Rigid3 last = walk.pose();
    motion.follow(last, walk.step(), Matrix6d::Zero(), kStep_s, true);
    EXPECT_FALSE(motion.predict(walk.pose(), kStep_s)) << i;
  }
  EXPECT_THAT(motion.expected(walk.pose(), kStep_s), testing::Not(PoseNear(walk.pose(), 1e-6, 1e-3)))
      << "but its velocity is known from the second pose on";
}

TEST(SteadyMotion, ItsUncertaintyIsHonest) {
  std::vector<double> one_step, five;
  for (unsigned seed = 0; seed < 60; ++seed) {
    Walk walk(kTurnQ, kWayQ, seed);
    const SteadyMotion motion = learned(&walk);
    const Rigid3 last = walk.pose();
    for (int k = 1; k <= 5; ++k) {
      walk.step();
      if (k != 1 && k != 5) continue;
      const auto prior = motion.predict(last, k * kStep_s);
      ASSERT_TRUE(prior);
      const Vector6d off = local(prior->cam_from_world, walk.pose());
      (k == 1 ? one_step : five).push_back(off.dot(prior->covariance.inverse() * off));
    }
  }
  // Of a chi-squared variable with six degrees of freedom 5.35.
  EXPECT_GT(median(one_step), 3);
  EXPECT_LT(median(one_step), 8);
  EXPECT_GT(median(five), 3);
  EXPECT_LT(median(five), 8);
}

// Poses of 5 cm and 20 mrad each, beside a prior: the filter's are far better.
TEST(SteadyMotion, BesidePoorPosesItHoldsTheWay) {
  Matrix6d poor = Matrix6d::Zero();
  poor.diagonal() << 4e-4, 4e-4, 4e-4, 2.5e-3, 2.5e-3, 2.5e-3;
  std::vector<double> errors_m, values;
  for (unsigned seed = 0; seed < 20; ++seed) {
    Walk walk(kTurnQ, kWayQ, seed);
    SteadyMotion motion = learned(&walk);
    Rigid3 estimate = walk.pose();
    for (int k = 0; k < 60; ++k) {
      const Rigid3 measured = retract(walk.step(), walk.noise(0.02, 0.05));
      const auto prior = motion.predict(estimate, kStep_s);
      ASSERT_TRUE(prior);
      Rigid3 next = prior->cam_from_world;
      Matrix6d information;
      for (int i = 0; i < 8; ++i) {  // least squares, weighed anew
        const PriorTerm term = prior_term(*prior, next);
        information = term.a + poor.inverse();
        next = retract(next, information.inverse() * (term.b + poor.inverse() * local(next, measured)));
      }
      motion.follow(estimate, next, information.inverse(), kStep_s, false);
      estimate = next;
      const Vector6d off = local(estimate, walk.pose());
      errors_m.push_back(off.tail<3>().norm());
      values.push_back(off.dot(information * off));
    }
  }
  EXPECT_LT(median(errors_m), 0.045) << "of 0.077 without it; 0.038 were the density known";
  EXPECT_LT(median(values), 9);
}

TEST(SteadyMotion, ACorrectionMendsTheVelocityToo) {
  Walk walk(0, 0, 3);
  SteadyMotion motion = learned(&walk);
  const Rigid3 last = walk.pose();
  walk.step();
  // A poor pose draws the velocity along; then somebody says where the camera was.
  Vector6d aside = Vector6d::Zero();
  aside[3] = 0.01;
  const Rigid3 wrong = retract(walk.pose(), aside);
  motion.follow(last, wrong, 1e-4 * Matrix6d::Identity(), kStep_s, false);
  SteadyMotion corrected = motion;
  corrected.correct(local(wrong, walk.pose()), 0);
  const Rigid3 now = walk.pose();
  walk.step();
  const auto missed_m = [&](const SteadyMotion& m) {
    return local(m.expected(now, kStep_s), walk.pose()).tail<3>().norm();
  };
  EXPECT_GT(missed_m(motion), 0.002);
  EXPECT_LT(missed_m(corrected), 0.15 * missed_m(motion));
}

TEST(SteadyMotion, AnotherPlaceForTheWorldIsNoVelocity) {
  Walk walk(kTurnQ, kWayQ, 3);
  SteadyMotion motion = learned(&walk);
  const Rigid3 before = motion.expected(walk.pose(), kStep_s);
  motion.correct(Vector6d::Constant(0.5), 0);
  EXPECT_THAT(motion.expected(walk.pose(), kStep_s), PoseNear(before, 1e-3, 1e-3));
}

TEST(SteadyMotion, IsTrueInAnotherUnit) {
  Walk walk(kTurnQ, kWayQ, 5);
  SteadyMotion motion = learned(&walk), other = motion;
  other.rescale(2);
  const auto a = motion.predict(Rigid3(), kStep_s), b = other.predict(Rigid3(), kStep_s);
  ASSERT_TRUE(a && b);
  EXPECT_LT((2 * a->cam_from_world.translation - b->cam_from_world.translation).norm(), 1e-12);
  EXPECT_LT((4 * a->covariance.bottomRightCorner<3, 3>() - b->covariance.bottomRightCorner<3, 3>()).norm(),
            1e-9 * b->covariance.norm());
  EXPECT_LT((a->covariance.topLeftCorner<3, 3>() - b->covariance.topLeftCorner<3, 3>()).norm(), 1e-15);
}

TEST(SteadyMotion, LostItIsWhereItWas) {
  Walk walk(kTurnQ, kWayQ, 6);
  SteadyMotion motion = learned(&walk);
  motion.lose();
  EXPECT_FALSE(motion.predict(walk.pose(), kStep_s));
  EXPECT_THAT(motion.expected(walk.pose(), kStep_s), PoseNear(walk.pose(), 1e-12, 1e-6));
}

TEST(PriorTerm, IsTheSlopeOfItsCost) {
  PosePrior prior{Rigid3(so3_exp({0.1, 0.2, -0.1}), {1, 2, 3}), Matrix6d::Identity()};
  prior.covariance.diagonal() << 1e-4, 2e-4, 3e-4, 1e-2, 2e-2, 1e-2;
  Vector6d off;
  off << 0.01, -0.02, 0.01, 0.1, 0.2, -0.1;
  const Rigid3 pose = retract(prior.cam_from_world, off);
  const PriorTerm term = prior_term(prior, pose);
  for (int i = 0; i < 6; ++i) {
    const Vector6d step = 1e-6 * Vector6d::Unit(i);
    const double slope =
        (prior_term(prior, retract(pose, step)).cost - prior_term(prior, retract(pose, -step)).cost) / 2e-6;
    EXPECT_NEAR(-term.b[i], slope, 0.02 * term.b.norm()) << i;
  }
  EXPECT_EQ(prior_term(prior, prior.cam_from_world).cost, 0);
}

}  // namespace
}  // namespace coslam::steady_motion_test
