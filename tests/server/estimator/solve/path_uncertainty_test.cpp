// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/solve/path_uncertainty.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "common/geometry/alignment.h"
#include "tests/support/sim_map.h"

namespace coslam::path_uncertainty_test {
namespace {

constexpr double kSigmaPx = 0.5;

// A camera that looks to the side along a wall of points: each pose shares points with the next few alone.
BundleProblem corridor(int poses, double step_m = 0.25) {
  BundleProblem p;
  p.cameras = {test::sim_camera()};
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int i = 0; i < poses; ++i) p.poses.push_back({test::looking({step_m * i, 0.02 * (i % 5), 0}, 0), 0});
  const int points = static_cast<int>(40 * step_m * poses);
  for (int j = 0; j < points; ++j) {
    const Eigen::Vector3d at(step_m * poses * uniform(random), 2 * uniform(random) - 1, 2 + 2 * uniform(random));
    std::vector<BundleProblem::Observation> seen;
    for (int i = 0; i < poses; ++i) {
      const Eigen::Vector3d x = p.poses[static_cast<std::size_t>(i)].cam_from_world * at;
      const Eigen::Vector2d px = p.cameras[0].project(x);
      if (x.z() > 0.5 && p.cameras[0].contains_raw(px))
        seen.push_back({i, static_cast<int>(p.points.size()), px, kSigmaPx});
    }
    if (seen.size() < 3) continue;
    p.points.push_back(at);
    p.observations.insert(p.observations.end(), seen.begin(), seen.end());
  }
  return p;
}

double rms(const std::vector<std::optional<double>>& variances) {
  double sum = 0;
  for (const auto& variance : variances) sum += variance.value();
  return std::sqrt(sum / static_cast<double>(variances.size()));
}

double rms(const BundleProblem& problem) {
  return rms(centre_variances(problem, std::vector<bool>(problem.observations.size(), true)));
}

TEST(PathUncertainty, IsTheScatterOfManySolutions) {
  constexpr int kSolutions = 25;
  const BundleProblem exact = corridor(24);
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(0, kSigmaPx);
  std::vector<Eigen::Vector3d> centres;
  for (const auto& p : exact.poses) centres.push_back(p.cam_from_world.center());
  double scatter2 = 0;
  for (int k = 0; k < kSolutions; ++k) {
    BundleProblem noisy = exact;
    noisy.poses[0].fixed = true;
    for (auto& o : noisy.observations) o.undistorted_px += Eigen::Vector2d(normal(random), normal(random));
    const BundleResult r = solve_bundle(noisy, {.max_iterations = 40, .function_tolerance = 1e-8, .loss_sigmas = 100});
    ASSERT_TRUE(r.usable);
    std::vector<Eigen::Vector3d> found;
    for (const Rigid3& p : r.poses) found.push_back(p.center());
    const auto truth_from_found = align_points(found, centres, AlignmentScale::kFree).target_from_source;
    ASSERT_TRUE(truth_from_found);
    for (std::size_t i = 0; i < found.size(); ++i)
      scatter2 += (*truth_from_found * found[i] - centres[i]).squaredNorm();
  }
  const double scatter = std::sqrt(scatter2 / static_cast<double>(kSolutions * centres.size()));
  EXPECT_NEAR(scatter / rms(exact), 1, 0.25);
}

TEST(PathUncertainty, OfALongWayIsToldFromNeighbourToNeighbour) {
  // Drift grows with the power of one and a half to two and a half of the way; no pose sees what the far ones do.
  const double some = rms(corridor(100)), many = rms(corridor(400));
  EXPECT_GT(many / some, 6);
  EXPECT_LT(many / some, 40);
  EXPECT_LT(many, 0.05 * 100) << "metres, of a way of 100 m";
}

TEST(PathUncertainty, DoesNotDependOnWhereTheMapBegins) {
  BundleProblem problem = corridor(24);
  const double here = rms(problem);
  const Rigid3 there_from_here = test::looking({300, -20, 5}, 1.2);
  for (auto& p : problem.poses) p.cam_from_world = p.cam_from_world * there_from_here.inverse();
  for (auto& p : problem.points) p = there_from_here * p;
  EXPECT_NEAR(rms(problem) / here, 1, 1e-3);
}

TEST(PathUncertainty, OfPosesThatStayOrSeeTooLittleIsNotTold) {
  BundleProblem problem = corridor(24);
  problem.poses[0].fixed = problem.poses[1].fixed = true;
  std::vector<bool> use(problem.observations.size(), true);
  int left = 7;
  for (std::size_t i = 0; i < use.size(); ++i) {
    if (problem.observations[i].pose == 9) use[i] = left-- > 0;
  }
  const auto variances = centre_variances(problem, use);
  for (int i = 0; i < 24; ++i) {
    EXPECT_EQ(variances[static_cast<std::size_t>(i)].has_value(), i > 1 && i != 9) << i;
  }
}

TEST(PathUncertainty, AgreeingObservationsAreThoseThatFit) {
  BundleProblem problem = corridor(12);
  problem.observations[3].undistorted_px.x() += 5 * kSigmaPx;
  problem.observations[4].undistorted_px.y() += 3 * kSigmaPx;
  const std::vector<bool> agree = agreeing(problem, 4);
  for (std::size_t i = 0; i < agree.size(); ++i) EXPECT_EQ(agree[i], i != 3) << i;
}

}  // namespace
}  // namespace coslam::path_uncertainty_test
