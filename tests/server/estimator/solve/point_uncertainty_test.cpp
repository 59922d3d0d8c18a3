// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/solve/point_uncertainty.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>
#include <vector>

#include "common/geometry/alignment.h"
#include "common/geometry/triangulation.h"
#include "tests/support/sim_map.h"

namespace coslam::point_uncertainty_test {
namespace {

constexpr double kSigmaPx = 0.5;
constexpr int kDraws = 25;

// Eight images of 60 points from two cameras, exact; noise comes with each draw.
class PointUncertaintyTest : public testing::Test {
 protected:
  PointUncertaintyTest() {
    exact_.cameras = {test::sim_camera()};
    for (int i = 0; i < 8; ++i) {
      exact_.poses.push_back({test::looking({0.25 * (i / 2) - 1 + 1.2 * (i % 2), 0.05 * i, 0}, 0.02 * i - 0.1), 0});
    }
    const test::SimWorld world({.seed = 3, .points = 60});
    for (int j = 0; j < world.size(); ++j) {
      std::vector<BundleProblem::Observation> seen;
      for (int i = 0; i < 8; ++i) {
        const Eigen::Vector3d x = exact_.poses[static_cast<std::size_t>(i)].cam_from_world * world.position(j);
        const Eigen::Vector2d px = exact_.cameras[0].project(x);
        if (x.z() > 0.5 && exact_.cameras[0].contains_raw(px))
          seen.push_back({i, static_cast<int>(exact_.points.size()), px, kSigmaPx});
      }
      if (seen.size() < 4) continue;
      exact_.points.push_back(world.position(j));
      exact_.observations.insert(exact_.observations.end(), seen.begin(), seen.end());
    }
  }
  std::vector<Eigen::Matrix3d> share(std::size_t most = 100) const {
    return share_of_poses(exact_, std::vector<bool>(exact_.observations.size(), true), most);
  }
  Eigen::Matrix3d with_exact_poses(int point) const {
    std::vector<View> views;
    for (const auto& o : exact_.observations) {
      if (o.point != point) continue;
      const auto& pose = exact_.poses[static_cast<std::size_t>(o.pose)];
      views.push_back({&exact_.cameras[0], pose.cam_from_world, o.undistorted_px});
    }
    return triangulation_covariance(views, exact_.points[static_cast<std::size_t>(point)], kSigmaPx);
  }
  BundleProblem exact_;
};

TEST_F(PointUncertaintyTest, TogetherWithExactPosesItIsTheScatterOfManySolutions) {
  const auto shares = share();
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(0, kSigmaPx);
  std::vector<Eigen::Vector3d> centres;
  for (const auto& p : exact_.poses) centres.push_back(p.cam_from_world.center());
  std::vector<double> marginal, conditional;
  for (int draw = 0; draw < kDraws; ++draw) {
    BundleProblem noisy = exact_;
    noisy.poses[0].fixed = true;
    for (auto& o : noisy.observations) o.undistorted_px += Eigen::Vector2d(normal(random), normal(random));
    const BundleResult r = solve_bundle(noisy, {.max_iterations = 30, .loss_sigmas = 100});
    ASSERT_TRUE(r.usable);
    std::vector<Eigen::Vector3d> found;
    for (const Rigid3& p : r.poses) found.push_back(p.center());
    const auto truth_from_found = align_points(found, centres, AlignmentScale::kFree).target_from_source;
    ASSERT_TRUE(truth_from_found);
    for (std::size_t j = 0; j < exact_.points.size(); ++j) {
      const Eigen::Vector3d error = *truth_from_found * r.points[j] - exact_.points[j];
      const Eigen::Matrix3d known = with_exact_poses(static_cast<int>(j));
      conditional.push_back(test::nees(error, known));
      marginal.push_back(test::nees(error, known + shares[j]));
    }
  }
  EXPECT_NEAR(test::median(marginal), 2.37, 0.4);
  EXPECT_GT(test::median(conditional), 3.5) << "which is why it is needed";
}

TEST_F(PointUncertaintyTest, FewerPosesAreOnTheSafeSide) {
  const auto all = share(), some = share(5);
  int larger = 0;
  for (std::size_t j = 0; j < all.size(); ++j) larger += some[j].trace() >= all[j].trace();
  EXPECT_GT(larger, 0.8 * static_cast<double>(all.size()));
}

TEST_F(PointUncertaintyTest, ExactPosesAddNothing) {
  for (auto& p : exact_.poses) p.fixed = true;
  for (const Eigen::Matrix3d& s : share()) EXPECT_EQ(s, Eigen::Matrix3d::Zero());
}

TEST_F(PointUncertaintyTest, UnusedObservationsDoNotCount) {
  std::vector<bool> use(exact_.observations.size(), true);
  for (std::size_t i = 0; i < use.size(); ++i) use[i] = exact_.observations[i].point != 7;
  const auto without = share_of_poses(exact_, use, 100);
  EXPECT_EQ(without[7], Eigen::Matrix3d::Zero());
  EXPECT_GT(without[8].trace(), 0);
}

}  // namespace
}  // namespace coslam::point_uncertainty_test
