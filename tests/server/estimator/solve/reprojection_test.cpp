// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/solve/reprojection.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "common/geometry/lens_correction.h"
#include "common/geometry/rigid3.h"
#include "tests/support/matchers.h"
#include "tests/support/sim_world.h"

namespace coslam::reprojection_test {
namespace {

Vector6d random_tangent(std::mt19937& random, double most) {
  std::uniform_real_distribution<double> uniform(-most, most);
  return Vector6d::NullaryExpr([&] { return uniform(random); });
}

const CameraModel kCamera = test::sim_camera();
const Eigen::Vector2d kPx(300, 200);

Reprojection reprojected(const Rigid3& pose, const Eigen::Vector3d& point, double sigma_px) {
  const Eigen::Matrix2d whiten = kCamera.raw_by_undistorted(kPx) / sigma_px;
  return reprojection(kCamera, whiten, kPx, pose.rotation.toRotationMatrix(), pose.translation, point);
}

TEST(ReprojectionTest, IsTheWeightedReprojectionError) {
  const Rigid3 pose = test::looking({0.3, 0.1, -0.5}, 0.2);
  const Eigen::Vector3d point(0.5, -0.4, 5);
  const Eigen::Vector2d expected = (kCamera.project(pose * point) - kPx) / 0.5;
  EXPECT_THAT(reprojected(pose, point, 0.5).residual, test::VectorNear(expected, 1e-9));
}

TEST(ReprojectionTest, DerivativesNumerically) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> side(-2, 2), depth(1.5, 9);
  constexpr double h = 1e-6;
  for (int trial = 0; trial < 50; ++trial) {
    const Rigid3 pose = retract({}, random_tangent(random, 1.5));
    const Eigen::Vector3d point = pose.inverse() * Eigen::Vector3d(side(random), side(random), depth(random));
    const auto residual = [](const Rigid3& p, const Eigen::Vector3d& x) { return reprojected(p, x, 0.7).residual; };
    const Reprojection r = reprojected(pose, point, 0.7);
    for (int i = 0; i < 6; ++i) {
      const Vector6d d = h * Vector6d::Unit(i), minus_d = -d;
      const Eigen::Vector2d numeric =
          (residual(retract(pose, d), point) - residual(retract(pose, minus_d), point)) / (2 * h);
      EXPECT_THAT(r.by_pose.col(i), test::VectorNear(numeric, 1e-5 * r.by_pose.norm())) << i;
    }
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d d = h * Eigen::Vector3d::Unit(i);
      const Eigen::Vector2d numeric = (residual(pose, point + d) - residual(pose, point - d)) / (2 * h);
      EXPECT_THAT(r.by_point.col(i), test::VectorNear(numeric, 1e-5 * r.by_point.norm())) << i;
    }
  }
}

TEST(ReprojectionTest, BehindTheCameraIsAConstantThatPullsNothing) {
  const Reprojection r = reprojected({}, {0.1, 0.1, -2}, 1.0);
  EXPECT_GT(r.residual.norm(), 1000);
  EXPECT_EQ(r.by_pose.norm(), 0);
  EXPECT_EQ(r.by_point.norm(), 0);
}

Reprojection through(const LensCorrection& lens, const Rigid3& pose, const Eigen::Vector3d& point,
                     Eigen::Matrix<double, 2, LensCorrection::kTerms>* by_lens) {
  return lens_reprojection({kCamera, lens}, kCamera.raw_from_undistorted(kPx), 0.7, pose.rotation.toRotationMatrix(),
                           pose.translation, point, by_lens);
}

TEST(LensReprojectionTest, IsTheOtherWithALensThatIsAsCalibrated) {
  const Rigid3 pose = test::looking({0.3, 0.1, -0.5}, 0.2);
  const Eigen::Vector3d point = pose.inverse() * Eigen::Vector3d(-0.2, -0.25, 5);
  Eigen::Matrix<double, 2, LensCorrection::kTerms> by_lens;
  const Reprojection r = through({}, pose, point, &by_lens), expected = reprojected(pose, point, 0.7);
  EXPECT_LT((r.residual - expected.residual).norm(), 1e-9);
  EXPECT_LT((r.by_pose - expected.by_pose).norm(), 1e-9);
  EXPECT_LT((r.by_point - expected.by_point).norm(), 1e-9);
}

TEST(LensReprojectionTest, DerivativesNumerically) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> side(-2, 2), depth(2, 9), unit(-1, 1);
  constexpr double h = 1e-6;
  for (int trial = 0; trial < 30; ++trial) {
    const Rigid3 pose = retract({}, random_tangent(random, 1.5));
    const Eigen::Vector3d point = pose.inverse() * Eigen::Vector3d(side(random), side(random), depth(random));
    LensCorrection lens;
    lens.values = LensCorrection::Values::NullaryExpr([&] { return 0.02 * unit(random); });
    lens.values.segment<2>(1) *= 200;  // pixels
    Eigen::Matrix<double, 2, LensCorrection::kTerms> by_lens, unused;
    const Reprojection r = through(lens, pose, point, &by_lens);
    const auto residual = [&](const LensCorrection& l, const Rigid3& p, const Eigen::Vector3d& x) {
      return through(l, p, x, &unused).residual;
    };
    for (int i = 0; i < 6; ++i) {
      const Vector6d d = h * Vector6d::Unit(i), minus_d = -d;
      const Eigen::Vector2d numeric =
          (residual(lens, retract(pose, d), point) - residual(lens, retract(pose, minus_d), point)) / (2 * h);
      EXPECT_THAT(r.by_pose.col(i), test::VectorNear(numeric, 1e-5 * r.by_pose.norm())) << i;
    }
    for (int i = 0; i < LensCorrection::kTerms; ++i) {
      const LensCorrection::Values d = h * LensCorrection::Values::Unit(i);
      const Eigen::Vector2d by_value =
          (residual({lens.values + d}, pose, point) - residual({lens.values - d}, pose, point)) / (2 * h);
      EXPECT_THAT(by_lens.col(i), test::VectorNear(by_value, 1e-4 * by_lens.norm())) << i;
    }
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d d = h * Eigen::Vector3d::Unit(i);
      const Eigen::Vector2d numeric = (residual(lens, pose, point + d) - residual(lens, pose, point - d)) / (2 * h);
      EXPECT_THAT(r.by_point.col(i), test::VectorNear(numeric, 1e-5 * r.by_point.norm())) << i;
    }
  }
}

TEST(TieTest, IsZeroWhereTheTieHolds) {
  std::mt19937 random(4);
  const Rigid3 held = retract({}, random_tangent(random, 1)), first = retract({}, random_tangent(random, 1));
  EXPECT_LT(tie(held, first, held * first).residual.norm(), 1e-7);
}

TEST(TieTest, DerivativesNumerically) {
  std::mt19937 random(3);
  constexpr double h = 1e-7;
  for (int trial = 0; trial < 30; ++trial) {
    const Rigid3 held = retract({}, random_tangent(random, 1)), first = retract({}, random_tangent(random, 1.5));
    const Rigid3 second = retract(held * first, random_tangent(random, 0.3));
    const Tie is = tie(held, first, second);
    for (int i = 0; i < 6; ++i) {
      const Vector6d d = h * Vector6d::Unit(i), minus_d = -d;
      const Vector6d by_first =
          (tie(held, retract(first, d), second).residual - tie(held, retract(first, minus_d), second).residual) /
          (2 * h);
      const Vector6d by_second =
          (tie(held, first, retract(second, d)).residual - tie(held, first, retract(second, minus_d)).residual) /
          (2 * h);
      EXPECT_THAT(is.by_first.col(i), test::VectorNear(by_first, 1e-5 * is.by_first.norm())) << i;
      EXPECT_THAT(is.by_second.col(i), test::VectorNear(by_second, 1e-5 * is.by_second.norm())) << i;
    }
  }
}

}  // namespace
}  // namespace coslam::reprojection_test
