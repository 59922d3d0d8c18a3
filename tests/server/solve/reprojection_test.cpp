// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/solve/reprojection.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <random>

#include "common/geometry/rigid3.h"
#include "server/solve/lens.h"
#include "tests/support/matchers.h"
#include "tests/support/sim_world.h"

namespace coslam {
namespace {

using Block = std::array<double, 7>;

Block block_of(const Rigid3& pose) {
  Block b{};
  Eigen::Map<Eigen::Quaterniond>(b.data()) = pose.rotation;
  Eigen::Map<Eigen::Vector3d>(b.data() + 4) = pose.translation;
  return b;
}

Rigid3 pose_of(const Block& b) {
  return {Eigen::Map<const Eigen::Quaterniond>(b.data()), Eigen::Map<const Eigen::Vector3d>(b.data() + 4)};
}

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

TEST(PoseManifold, PlusIsRetractAndMinusIsLocal) {
  const auto manifold = make_pose_manifold();
  ASSERT_EQ(manifold->AmbientSize(), 7);
  ASSERT_EQ(manifold->TangentSize(), 6);
  std::mt19937 random(1);
  for (int i = 0; i < 20; ++i) {
    const Rigid3 pose = retract({}, random_tangent(random, 2));
    const Vector6d d = random_tangent(random, 0.7);
    const Block from = block_of(pose);
    Block to{};
    ASSERT_TRUE(manifold->Plus(from.data(), d.data(), to.data()));
    EXPECT_THAT(pose_of(to), test::PoseNear(retract(pose, d), 1e-7, 1e-12));
    Vector6d back;
    ASSERT_TRUE(manifold->Minus(to.data(), from.data(), back.data()));
    EXPECT_LT((back - d).norm(), 1e-9);
  }
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

TEST(LensReprojectionCost, IsTheOtherWithALensThatIsAsCalibrated) {
  const auto lens = make_lens_reprojection_cost(kCamera, kPx, 0.7);
  const Rigid3 pose = test::looking({0.3, 0.1, -0.5}, 0.2);
  const Block block = block_of(pose);
  const Eigen::Vector3d point(0.5, -0.4, 5);
  const LensChange none;
  const double* parameters[] = {block.data(), point.data(), none.values.data()};
  Eigen::Vector2d r;
  Eigen::Matrix<double, 2, 7, Eigen::RowMajor> by_block;
  Eigen::Matrix<double, 2, 3, Eigen::RowMajor> by_point;
  double* jacobians[] = {by_block.data(), by_point.data(), nullptr};
  ASSERT_TRUE(lens->Evaluate(parameters, r.data(), jacobians));
  const Reprojection expected = reprojected(pose, point, 0.7);
  EXPECT_LT((r - expected.residual).norm(), 1e-9);
  EXPECT_LT((by_block.leftCols<6>() - expected.by_pose).norm(), 1e-9);
  EXPECT_LT((by_point - expected.by_point).norm(), 1e-9);
}

TEST(LensReprojectionCost, JacobiansNumerically) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> side(-2, 2), depth(2, 9), unit(-1, 1);
  const auto cost = make_lens_reprojection_cost(kCamera, kPx, 0.7);
  constexpr double h = 1e-6;
  for (int trial = 0; trial < 30; ++trial) {
    const Rigid3 pose = retract({}, random_tangent(random, 1.5));
    const Block block = block_of(pose);
    std::array<double, 3> point{};
    Eigen::Map<Eigen::Vector3d>(point.data()) =
        pose.inverse() * Eigen::Vector3d(side(random), side(random), depth(random));
    std::array<double, 5> lens{0.1 * unit(random), 5 * unit(random), 5 * unit(random), 0.1 * unit(random),
                               0.05 * unit(random)};
    const double* parameters[] = {block.data(), point.data(), lens.data()};
    Eigen::Vector2d r;
    Eigen::Matrix<double, 2, 7, Eigen::RowMajor> by_block;
    Eigen::Matrix<double, 2, 3, Eigen::RowMajor> by_point;
    Eigen::Matrix<double, 2, 5, Eigen::RowMajor> by_lens;
    double* jacobians[] = {by_block.data(), by_point.data(), by_lens.data()};
    ASSERT_TRUE(cost->Evaluate(parameters, r.data(), jacobians));
    const auto numeric = [&](double& value) -> Eigen::Vector2d {
      Eigen::Vector2d above, below;
      const double before = value;
      value = before + h;
      EXPECT_TRUE(cost->Evaluate(parameters, above.data(), nullptr));
      value = before - h;
      EXPECT_TRUE(cost->Evaluate(parameters, below.data(), nullptr));
      value = before;
      return (above - below) / (2 * h);
    };
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_THAT(by_point.col(static_cast<int>(i)), test::VectorNear(numeric(point[i]), 1e-5 * by_point.norm()));
    }
    for (std::size_t i = 0; i < 5; ++i) {
      EXPECT_THAT(by_lens.col(static_cast<int>(i)), test::VectorNear(numeric(lens[i]), 1e-5 * by_lens.norm())) << i;
    }
    // By the pose as the camera moves in its own frame: the point goes the other way.
    const Eigen::Matrix<double, 2, 3> by_shift = by_block.middleCols<3>(3);
    EXPECT_LT((by_shift * pose.rotation.toRotationMatrix() - by_point).norm(), 1e-6 * by_point.norm());
  }
}

TEST(TieCost, IsZeroWhereTheTieHolds) {
  std::mt19937 random(4);
  const Rigid3 tie = retract({}, random_tangent(random, 1)), first = retract({}, random_tangent(random, 1));
  const auto cost = make_tie_cost(tie);
  const Block a = block_of(first), b = block_of(tie * first);
  const double* parameters[] = {a.data(), b.data()};
  Vector6d r;
  ASSERT_TRUE(cost->Evaluate(parameters, r.data(), nullptr));
  EXPECT_LT(r.norm(), 1e-7);
}

TEST(TieCost, JacobiansNumerically) {
  const auto manifold = make_pose_manifold();
  std::mt19937 random(3);
  constexpr double h = 1e-7;
  for (int trial = 0; trial < 30; ++trial) {
    const Rigid3 tie = retract({}, random_tangent(random, 1)), first = retract({}, random_tangent(random, 1.5));
    const auto cost = make_tie_cost(tie);
    const Rigid3 second = retract(tie * first, random_tangent(random, 0.3));
    const std::array<Block, 2> blocks{block_of(first), block_of(second)};
    const auto residual = [&](const Block& a, const Block& b) {
      const double* parameters[] = {a.data(), b.data()};
      Vector6d r;
      EXPECT_TRUE(cost->Evaluate(parameters, r.data(), nullptr));
      return r;
    };
    std::array<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>, 2> by_block;
    const double* parameters[] = {blocks[0].data(), blocks[1].data()};
    double* jacobians[] = {by_block[0].data(), by_block[1].data()};
    Vector6d r;
    ASSERT_TRUE(cost->Evaluate(parameters, r.data(), jacobians));
    for (std::size_t which = 0; which < 2; ++which) {
      Eigen::Matrix<double, 7, 6, Eigen::RowMajor> plus;
      ASSERT_TRUE(manifold->PlusJacobian(blocks[which].data(), plus.data()));
      const Eigen::Matrix<double, 6, 6> by_pose = by_block[which] * plus;
      for (int i = 0; i < 6; ++i) {
        const Vector6d d = h * Vector6d::Unit(i), minus_d = -d;
        std::array<Block, 2> above = blocks, below = blocks;
        ASSERT_TRUE(manifold->Plus(blocks[which].data(), d.data(), above[which].data()));
        ASSERT_TRUE(manifold->Plus(blocks[which].data(), minus_d.data(), below[which].data()));
        const Vector6d numeric = (residual(above[0], above[1]) - residual(below[0], below[1])) / (2 * h);
        EXPECT_THAT(by_pose.col(i), test::VectorNear(numeric, 1e-5 * by_pose.norm())) << which << " " << i;
      }
    }
  }
}

}  // namespace
}  // namespace coslam
