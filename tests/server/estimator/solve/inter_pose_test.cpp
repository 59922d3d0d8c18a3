// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/solve/inter_pose.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

#include "tests/support/matchers.h"
#include "tests/support/sim_map.h"

namespace coslam::inter_pose_test {
namespace {

using test::PoseNear;

// Three cameras side by side; `statics` of the world's points are static and known to each, 40 others move: their
// places are unknown.
class InterPoseSolve : public testing::Test {
 protected:
  struct Setting {
    std::vector<int> statics{60, 60, 60};  // known points of each camera
    double noise_px = 0.3, outliers = 0;
  };
  InterPoseProblem make(const Setting& setting, unsigned seed = 1) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform(0, 1);
    const test::SimWorld world({.seed = 4, .points = 300});
    truth_ = {test::looking({-1.2, 0, 0}, 0.08), test::looking({0, 0.1, 0}), test::looking({1.2, 0, 0.2}, -0.08)};
    InterPoseProblem p;
    const auto see = [&](std::size_t c, const Eigen::Vector3d& x) -> std::optional<Eigen::Vector2d> {
      const Eigen::Vector3d in_cam = truth_[c] * x;
      if (in_cam.z() < 0.5 || !model_.contains_raw(model_.project(in_cam), 4)) return std::nullopt;
      Eigen::Vector2d px = model_.project(in_cam) + setting.noise_px * Eigen::Vector2d(normal(random), normal(random));
      if (uniform(random) < setting.outliers) px += Eigen::Vector2d(20 + 20 * uniform(random), -30 * uniform(random));
      return px;
    };
    for (std::size_t c = 0; c < 3; ++c) {
      Vector6d off;
      for (int k = 0; k < 6; ++k) off[k] = (k < 3 ? 0.01 : 0.04) * normal(random);
      p.cameras.push_back({&model_, retract(truth_[c], off), setting.noise_px, {}});
      for (int i = 0; i < world.size() && static_cast<int>(p.cameras[c].statics.size()) < setting.statics[c]; ++i) {
        const auto px = see(c, world.position(i));
        if (px) p.cameras[c].statics.push_back({world.position(i), 1e-6 * Eigen::Matrix3d::Identity(), *px});
      }
    }
    for (int i = world.size() - 1; i >= 0 && p.moving.size() < 40; --i) {
      InterPoseProblem::MovingPoint m{
          world.position(i) + 0.1 * Eigen::Vector3d(normal(random), normal(random), normal(random)), {}};
      for (int c = 0; c < 3; ++c) {
        if (const auto px = see(static_cast<std::size_t>(c), world.position(i))) m.seen.emplace_back(c, *px);
      }
      if (m.seen.size() < 2) continue;
      moving_.push_back(world.position(i));
      p.moving.push_back(m);
    }
    return p;
  }
  const CameraModel model_ = test::sim_camera();
  std::vector<Rigid3> truth_;
  std::vector<Eigen::Vector3d> moving_;
};

TEST_F(InterPoseSolve, FindsPosesAndMovingPoints) {
  const InterPoseProblem p = make({});
  const InterPoseResult r = solve_inter_pose(p, 20);
  ASSERT_TRUE(r.ok);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_THAT(r.cameras[c].cam_from_world, PoseNear(truth_[c], 0.004, 0.01)) << c;
  std::vector<double> errors;
  for (std::size_t m = 0; m < moving_.size(); ++m) errors.push_back((r.moving[m] - moving_[m]).norm());
  EXPECT_EQ(errors.size(), 40U);
  EXPECT_LT(test::median(errors), 0.03);
}

TEST_F(InterPoseSolve, ACameraWithTwoKnownPointsIsHeldByWhatMoves) {
  const InterPoseProblem p = make({.statics = {60, 60, 2}});
  const InterPoseResult r = solve_inter_pose(p, 20);
  ASSERT_TRUE(r.ok);
  EXPECT_THAT(r.cameras[2].cam_from_world, PoseNear(truth_[2], 0.006, 0.03));
  EXPECT_GT(r.cameras[2].inliers, 30);
  InterPoseProblem alone = p;
  alone.moving.clear();
  EXPECT_FALSE(solve_inter_pose(alone, 20).ok) << "two points do not tell where it is";
}

TEST_F(InterPoseSolve, StandsWrongObservations) {
  const InterPoseResult r = solve_inter_pose(make({.statics = {60, 60, 20}, .outliers = 0.15}), 30);
  ASSERT_TRUE(r.ok);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_THAT(r.cameras[c].cam_from_world, PoseNear(truth_[c], 0.006, 0.02)) << c;
}

TEST_F(InterPoseSolve, ItsCovarianceIsHonest) {
  std::vector<double> values;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const InterPoseResult r = solve_inter_pose(make({.statics = {60, 60, 4}}, seed), 30);
    ASSERT_TRUE(r.ok);
    for (std::size_t c = 0; c < 3; ++c) {
      const Vector6d error = local(r.cameras[c].cam_from_world, truth_[c]);
      values.push_back(error.dot(r.cameras[c].covariance.inverse() * error));
    }
  }
  EXPECT_NEAR(test::median(values), 5.35, 2.0);  // of a chi-squared variable with six degrees of freedom
}

// Eight moving points of 3 px hardly tell where a camera is that has nothing else.
TEST_F(InterPoseSolve, APriorHoldsACameraThatLittleElseHolds) {
  std::vector<double> with_m, without_m;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    InterPoseProblem p = make({.statics = {60, 60, 2}, .noise_px = 1.5}, seed);
    p.moving.resize(8);
    const auto error_m = [&](const InterPoseResult& r) {
      return (r.cameras[2].cam_from_world.center() - truth_[2].center()).norm();
    };
    const InterPoseResult poor = solve_inter_pose(p, 30);
    Vector6d off;
    off << 0.001, -0.001, 0.002, 0.004, -0.005, 0.005;
    p.cameras[2].prior = {retract(truth_[2], off), Matrix6d::Zero()};
    p.cameras[2].prior->covariance.diagonal() << 4e-6, 4e-6, 4e-6, 2.5e-5, 2.5e-5, 2.5e-5;
    const InterPoseResult r = solve_inter_pose(p, 30);
    ASSERT_TRUE(r.ok);
    with_m.push_back(error_m(r));
    without_m.push_back(poor.ok ? error_m(poor) : 1.0);
  }
  EXPECT_LT(test::median(with_m), 0.012);
  EXPECT_LT(test::median(with_m), 0.5 * test::median(without_m));
}

}  // namespace
}  // namespace coslam::inter_pose_test
