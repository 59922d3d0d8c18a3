// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/solve/bundle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "common/geometry/triangulation.h"
#include "server/estimator/solve/bundle_schur.h"
#include "tests/support/ceres_bundle.h"
#include "tests/support/matchers.h"
#include "tests/support/sim_map.h"
#include "tests/support/sim_world.h"

namespace coslam::bundle_test {
namespace {

using test::looking;
using test::PoseNear;
using test::VectorNear;

struct Scene {
  double noise_px = 0.5;
  double outliers = 0;
  double off_m = 0.05, off_rad = 0.02;  // standard deviation of the initial values, each coordinate
  int fixed = 2;                        // of the poses, from the first; these are true
};

// Twelve images of 150 points from two cameras that move side by side, with truth.
class BundleTest : public testing::Test {
 protected:
  BundleProblem make(const Scene& scene, unsigned seed = 1) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform(0, 1);
    const test::SimWorld world({.seed = 3, .points = 150});
    BundleProblem p;
    p.cameras = {test::sim_camera(), test::sim_camera()};
    for (int i = 0; i < 12; ++i) {
      const int camera = i % 2;
      poses_.push_back(looking({0.3 * (i / 2) - 1 + camera, 0.05 * i, 0}, 0.02 * i - 0.1));
      Vector6d d;
      for (int k = 0; k < 6; ++k) d[k] = (k < 3 ? scene.off_rad : scene.off_m) * normal(random);
      const bool fixed = i < scene.fixed;
      p.poses.push_back({fixed ? poses_.back() : retract(poses_.back(), d), camera, fixed});
    }
    for (int j = 0; j < world.size(); ++j) {
      points_.push_back(world.position(j));
      p.points.emplace_back(world.position(j) +
                            scene.off_m * Eigen::Vector3d(normal(random), normal(random), normal(random)));
      for (int i = 0; i < 12; ++i) {
        const Eigen::Vector3d x = poses_[static_cast<std::size_t>(i)] * world.position(j);
        if (x.z() < 0.5 || !p.cameras[0].contains_raw(p.cameras[0].project(x))) continue;
        Eigen::Vector2d px = p.cameras[0].project(x) + scene.noise_px * Eigen::Vector2d(normal(random), normal(random));
        wrong_.push_back(uniform(random) < scene.outliers);
        if (wrong_.back()) px += Eigen::Vector2d(15 + 40 * uniform(random), 15 - 60 * uniform(random));
        p.observations.push_back({i, j, px, std::max(scene.noise_px, 0.1)});
      }
    }
    return p;
  }
  double worst_pose_m(const BundleResult& r) const {
    double worst = 0;
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      worst = std::max(worst, (r.poses[i].center() - poses_[i].center()).norm());
    }
    return worst;
  }
  double median_point_m(const BundleResult& r) const {
    std::vector<double> errors;
    for (std::size_t j = 0; j < points_.size(); ++j) errors.push_back((r.points[j] - points_[j]).norm());
    return test::median(errors);
  }
  // Against what the observations of a point can tell from true poses.
  double median_point_nees(const BundleResult& r, double sigma_px) const {
    const CameraModel camera = test::sim_camera();
    std::vector<double> values;
    for (std::size_t j = 0; j < points_.size(); ++j) {
      std::vector<View> views;
      for (const Rigid3& pose : poses_) {
        const Eigen::Vector3d x = pose * points_[j];
        if (x.z() > 0.5 && camera.contains_raw(camera.project(x))) views.push_back({&camera, pose, camera.project(x)});
      }
      if (views.size() < 2) continue;
      values.push_back(test::nees(r.points[j] - points_[j], triangulation_covariance(views, points_[j], sigma_px)));
    }
    return test::median(values);
  }
  std::vector<Rigid3> poses_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<bool> wrong_;
};

TEST_F(BundleTest, ExactObservationsGiveTruth) {
  const BundleResult r = solve_bundle(make({.noise_px = 0}), {.max_iterations = 50});
  ASSERT_TRUE(r.usable);
  for (std::size_t i = 0; i < poses_.size(); ++i) EXPECT_THAT(r.poses[i], PoseNear(poses_[i], 1e-4, 1e-4)) << i;
  EXPECT_LT(median_point_m(r), 1e-4);
  EXPECT_LT(r.final_cost, 1e-3 * r.initial_cost);
}

TEST_F(BundleTest, ConvergesThroughNoise) {
  const BundleResult r = solve_bundle(make({.noise_px = 0.5}), {.max_iterations = 30});
  ASSERT_TRUE(r.usable);
  EXPECT_LT(worst_pose_m(r), 0.02);
  EXPECT_LT(median_point_nees(r, 0.5), 4);  // 2.4 if the poses were exact
  EXPECT_LT(r.final_cost, 0.1 * r.initial_cost);
  EXPECT_GT(r.iterations, 1);
  EXPECT_NEAR(r.sigma_px, 0.5, 0.1);
}

TEST_F(BundleTest, OutliersAreFlaggedAndHarmless) {
  const BundleResult r = solve_bundle(make({.noise_px = 0.5, .outliers = 0.1}), {.max_iterations = 30});
  ASSERT_TRUE(r.usable);
  EXPECT_LT(worst_pose_m(r), 0.02);
  ASSERT_EQ(r.is_inlier.size(), wrong_.size());
  int missed = 0, accused = 0, wrong = 0;
  for (std::size_t i = 0; i < wrong_.size(); ++i) {
    wrong += wrong_[i];
    missed += wrong_[i] && r.is_inlier[i];
    accused += !wrong_[i] && !r.is_inlier[i];
  }
  EXPECT_GT(wrong, 50);
  EXPECT_LT(missed, 0.03 * wrong);
  // 4 sigma on a norm of two is passed by 0.03 %; a point with a wrong observation takes few others along.
  EXPECT_LT(accused, 0.01 * static_cast<double>(wrong_.size()));
}

TEST_F(BundleTest, FixedPosesStay) {
  const BundleProblem p = make({.fixed = 5});
  const BundleResult r = solve_bundle(p, {});
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_THAT(r.poses[i], PoseNear(p.poses[i].cam_from_world, 1e-7, 1e-12)) << i;
  }
  EXPECT_GT((r.poses[5].center() - p.poses[5].cam_from_world.center()).norm(), 1e-4);
}

TEST_F(BundleTest, TwiceAtHalfTheWeightIsOnce) {
  const BundleProblem once = make({.outliers = 0.05});
  BundleProblem twice = once;
  twice.observations.insert(twice.observations.end(), once.observations.begin(), once.observations.end());
  for (auto& o : twice.observations) o.weight = 0.5;
  const BundleResult a = solve_bundle(once, {}), b = solve_bundle(twice, {});
  EXPECT_NEAR(b.final_cost, a.final_cost, 1e-6 * a.final_cost);
  for (std::size_t i = 0; i < a.poses.size(); ++i) EXPECT_THAT(b.poses[i], PoseNear(a.poses[i], 1e-6, 1e-6));
  for (std::size_t i = 0; i < a.is_inlier.size(); ++i) EXPECT_EQ(b.is_inlier[i], a.is_inlier[i]);
}

TEST_F(BundleTest, TheSameBitsEveryTime) {
  const BundleProblem p = make({.outliers = 0.05});
  const BundleResult a = solve_bundle(p, {}), b = solve_bundle(p, {});
  for (std::size_t i = 0; i < a.poses.size(); ++i) {
    EXPECT_EQ(a.poses[i].rotation.coeffs(), b.poses[i].rotation.coeffs());
    EXPECT_EQ(a.poses[i].translation, b.poses[i].translation);
  }
  for (std::size_t i = 0; i < a.points.size(); ++i) EXPECT_EQ(a.points[i], b.points[i]);
}

TEST_F(BundleTest, FixGaugeRestoresAnchorAndBaseline) {
  const BundleProblem p = make({.fixed = 0});
  BundleResult r = solve_bundle(p, {.max_iterations = 30});
  ASSERT_TRUE(r.usable);
  // Wherever a free solution floats to:
  const Similarity3 floated{1.7, so3_exp({0.3, -0.5, 0.1}), {1, 2, 3}};
  for (Rigid3& pose : r.poses) pose = transform_world(pose, floated);
  for (Eigen::Vector3d& point : r.points) point = floated * point;
  const Eigen::Vector2d px = p.cameras[0].project(r.poses[5] * r.points[7]);

  constexpr int kAnchor = 3, kEnd = 10;
  fix_gauge(p, kAnchor, kEnd, &r);
  EXPECT_THAT(r.poses[kAnchor], PoseNear(p.poses[kAnchor].cam_from_world, 1e-7, 1e-9));
  const auto baseline = [](const Rigid3& a, const Rigid3& b) { return (a.center() - b.center()).norm(); };
  EXPECT_NEAR(baseline(r.poses[kAnchor], r.poses[kEnd]),
              baseline(p.poses[kAnchor].cam_from_world, p.poses[kEnd].cam_from_world), 1e-9);
  EXPECT_THAT(p.cameras[0].project(r.poses[5] * r.points[7]), VectorNear(px, 1e-6)) << "images do not change";
}

TEST_F(BundleTest, PutBackUndoesAnyChangeOfTheWorld) {
  BundleProblem p = make({});
  BundleResult r;
  const Similarity3 change{
      1.3, Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 3).normalized())), {1, -2, 0.5}};
  for (const auto& pose : p.poses) r.poses.push_back(transform_world(pose.cam_from_world, change));
  for (const auto& point : p.points) r.points.push_back(change * point);
  put_back(p, &r);
  for (std::size_t i = 0; i < p.poses.size(); ++i)
    EXPECT_THAT(r.poses[i], PoseNear(p.poses[i].cam_from_world, 1e-7, 1e-9));
  EXPECT_THAT(r.points[3], VectorNear(p.points[3], 1e-9));
}

TEST_F(BundleTest, PutBackLeavesTheScaleToTies) {
  BundleProblem p = make({});
  p.ties.push_back({0, 1, Rigid3()});
  BundleResult r;
  for (const auto& pose : p.poses)
    r.poses.push_back(transform_world(pose.cam_from_world, {2, Eigen::Quaterniond::Identity(), {0, 0, 0}}));
  r.points = p.points;
  put_back(p, &r);
  const auto length = [](const Rigid3& a, const Rigid3& b) { return (a.center() - b.center()).norm(); };
  EXPECT_NEAR(length(r.poses[0], r.poses[10]), 2 * length(p.poses[0].cam_from_world, p.poses[10].cam_from_world), 1e-9);
}

TEST_F(BundleTest, FixGaugeLeavesASolutionWithoutBaselineAlone) {
  BundleProblem p = make({});
  p.poses[1].cam_from_world = p.poses[0].cam_from_world;
  BundleResult r;
  for (const auto& pose : p.poses) r.poses.push_back(pose.cam_from_world);
  r.points = p.points;
  fix_gauge(p, 0, 1, &r);
  EXPECT_THAT(r.poses[4], PoseNear(p.poses[4].cam_from_world, 1e-9, 1e-12));
}

TEST_F(BundleTest, APointBehindACameraIsAnOutlier) {
  BundleProblem p = make({.noise_px = 0.2});
  p.points.emplace_back(0, 0, -5);
  const int point = static_cast<int>(p.points.size()) - 1;
  for (const int pose : {0, 1, 2}) p.observations.push_back({pose, point, {320, 240}, 0.5});
  const BundleResult r = solve_bundle(p, {.max_iterations = 30});
  ASSERT_TRUE(r.usable);
  for (std::size_t i = p.observations.size() - 3; i < p.observations.size(); ++i) EXPECT_FALSE(r.is_inlier[i]);
  EXPECT_LT(worst_pose_m(r), 0.02);
}

// Two cameras a metre apart: what ties them holds the relative pose, and the scale that nothing else tells.
TEST_F(BundleTest, TiesHoldRelativePosesAndTheScale) {
  BundleProblem p = make({.noise_px = 0.3, .off_m = 0.01, .off_rad = 0.002, .fixed = 1});
  for (int i = 0; i < 12; i += 2) {
    const auto first = static_cast<std::size_t>(i), second = first + 1;
    p.ties.push_back({i, i + 1, poses_[second] * poses_[first].inverse()});
    p.poses[second].cam_from_world = p.ties.back().second_from_first * p.poses[first].cam_from_world;
  }
  BundleResult r = solve_bundle(p, {.max_iterations = 50});
  ASSERT_TRUE(r.usable);
  fix_gauge(p, 0, 11, &r);
  for (const auto& t : p.ties) {
    const Rigid3 is =
        r.poses[static_cast<std::size_t>(t.second)] * r.poses[static_cast<std::size_t>(t.first)].inverse();
    EXPECT_THAT(is, PoseNear(t.second_from_first, 1e-3, 5e-3));
  }
  const double length = (r.poses[10].center() - r.poses[0].center()).norm();
  const double truth = (poses_[10].center() - poses_[0].center()).norm();
  EXPECT_NEAR(length / truth, 1, 0.003);
  EXPECT_LT(worst_pose_m(r), 0.01);
}

// Calibrations that are 3 % off in focal length, some pixels in the centre, and lack a distortion.
TEST_F(BundleTest, LensesAreFound) {
  BundleProblem p = make({.noise_px = 0.3, .off_m = 0.01, .off_rad = 0.002});
  LensCorrection truth;
  truth.values << std::log(1.03), 4, -3, 0, 0, 0, -0.008, 0, 0, 0, 0, 0;
  for (auto& o : p.observations) {
    const Eigen::Vector3d x = poses_[static_cast<std::size_t>(o.pose)] * points_[static_cast<std::size_t>(o.point)];
    o.undistorted_px += truth.raw_from_normalized(p.cameras[0], x.hnormalized()) - p.cameras[0].project(x);
  }
  const BundleResult by_calibration = solve_bundle(p, {.max_iterations = 50});
  BundleProblem::Lens unknown;
  unknown.prior_sigma << 0.05, 12, 12, 0.002, 0.0005, 0.0005, 0.02, 0.005, 0.002, 0.001, 0.0005, 0.0002;
  p.lenses.assign(2, unknown);
  const BundleResult r = solve_bundle(p, {.max_iterations = 50});
  ASSERT_TRUE(r.usable);
  ASSERT_EQ(r.lenses.size(), 2U);
  ASSERT_EQ(r.lens_covariances.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const LensCorrection& lens = r.lenses[i];
    EXPECT_NEAR(std::exp(lens.log_focal()), 1.03, 0.006);
    EXPECT_THAT(lens.centre_px(), VectorNear(truth.centre_px(), 5)) << "a turn looks nearly like that";
    EXPECT_NEAR(lens.radial()[0], truth.radial()[0], 0.006);
    const LensCorrection::Values off = lens.values - truth.values;
    EXPECT_LT(off.dot(r.lens_covariances[i].ldlt().solve(off)), 40) << "it is known how well";
  }
  EXPECT_LT(worst_pose_m(r), 0.5 * worst_pose_m(by_calibration));
  EXPECT_LT(r.sigma_px, 0.5);
}

class BundleWithZooms : public BundleTest {
 protected:
  static double zoom(std::size_t pose) { return 0.02 * std::sin(0.9 * static_cast<double>(pose)); }
  // Seen by cameras whose focal length changes from image to image.
  BundleProblem make_zoomed(const Scene& scene) {
    BundleProblem p = make(scene);
    const Eigen::Vector2d centre(p.cameras[0].cx, p.cameras[0].cy);
    for (auto& o : p.observations) {
      o.undistorted_px = centre + std::exp(zoom(static_cast<std::size_t>(o.pose))) * (o.undistorted_px - centre);
    }
    p.lenses.assign(2, {.prior_sigma = LensCorrection::Values::Constant(1e-4)});
    return p;
  }
  static void free_zooms(BundleProblem* p) {
    for (int i = 0; i < static_cast<int>(p->poses.size()); ++i) {
      p->zooms.emplace_back(BundleProblem::Zoom{.before = i < 2 ? -1 : i - 2, .step_sigma = 0.03, .prior_sigma = 0.02});
    }
  }
};

TEST_F(BundleWithZooms, TheyAreFound) {
  const BundleProblem zoomed = make_zoomed({.noise_px = 0.3, .off_m = 0.01, .off_rad = 0.002});
  for (const bool lenses_are_given : {false, true}) {
    BundleProblem p = zoomed;
    for (auto& lens : p.lenses) lens.free = !lenses_are_given;
    const BundleResult without = solve_bundle(p, {.max_iterations = 50});
    free_zooms(&p);
    const BundleResult r = solve_bundle(p, {.max_iterations = 50});
    ASSERT_TRUE(r.usable);
    ASSERT_EQ(r.zooms.size(), p.poses.size());
    for (std::size_t i = 0; i < r.zooms.size(); ++i) EXPECT_NEAR(r.zooms[i], zoom(i), 0.008) << i;
    EXPECT_LT(r.sigma_px, 0.8 * without.sigma_px);
    EXPECT_LT(worst_pose_m(r), 0.5 * worst_pose_m(without));
  }
}

// Six poses of a camera share a column, of which the last may have places to spare.
TEST_F(BundleWithZooms, SomeImagesMayHaveNone) {
  BundleProblem p = make_zoomed({.noise_px = 0.3, .off_m = 0.01, .off_rad = 0.002});
  free_zooms(&p);
  p.zooms[4].reset();
  p.zooms[6]->before = 2;
  const BundleResult r = solve_bundle(p, {.max_iterations = 50});
  ASSERT_TRUE(r.usable);
  EXPECT_EQ(r.zooms[4], 0);
  EXPECT_NEAR(r.zooms[8], zoom(8), 0.01);
}

TEST_F(BundleWithZooms, TheCostIsLeastThere) {
  BundleProblem p = make_zoomed({.noise_px = 0.3, .off_m = 0.01, .off_rad = 0.002});
  free_zooms(&p);
  const BundleResult r = solve_bundle(p, {.max_iterations = 100, .function_tolerance = 1e-14});
  for (std::size_t i = 0; i < p.poses.size(); ++i) p.poses[i].cam_from_world = r.poses[i];
  for (std::size_t i = 0; i < p.lenses.size(); ++i) p.lenses[i].start = r.lenses[i];
  for (std::size_t i = 0; i < p.zooms.size(); ++i) p.zooms[i]->start = r.zooms[i];
  p.points = r.points;
  const auto cost = [&] { return solve_bundle(p, {.max_iterations = 0}).initial_cost; };
  EXPECT_NEAR(cost(), r.final_cost, 1e-9 * r.final_cost);
  for (auto& z : p.zooms) {
    constexpr double kStep = 1e-4;
    const double here = z->start;
    z->start = here + kStep;
    const double more = cost();
    z->start = here - kStep;
    const double less = cost();
    z->start = here;
    const double curvature = more + less - 2 * r.final_cost;
    EXPECT_GT(curvature, 0);
    EXPECT_LT(std::abs(more - less), 0.02 * curvature) << "within a hundredth of the step";
  }
}

// Where the start is 5 % away from them, as in a map that was made without.
TEST_F(BundleTest, TiesPullASolutionToTheirScale) {
  BundleProblem p = make({.noise_px = 0.3, .off_m = 0.01, .off_rad = 0.002, .fixed = 0});
  for (std::size_t i = 0; i < poses_.size(); i += 2) {
    p.ties.push_back({static_cast<int>(i), static_cast<int>(i + 1), poses_[i + 1] * poses_[i].inverse()});
  }
  for (auto& pose : p.poses) pose.cam_from_world.translation *= 1.05;
  for (Eigen::Vector3d& point : p.points) point *= 1.05;
  p.poses[0].fixed = true;
  const BundleResult r = solve_bundle(p, {.max_iterations = 50});
  ASSERT_TRUE(r.usable);
  const double length = (r.poses[10].center() - r.poses[0].center()).norm();
  const double truth = (poses_[10].center() - poses_[0].center()).norm();
  EXPECT_NEAR(length / truth, 1, 0.003);
}

TEST_F(BundleTest, IsTheLeastCostThatAnotherSolverFinds) {
  BundleProblem p = make({.outliers = 0.05, .fixed = 1});
  p.ties.push_back({2, 3, poses_[3] * poses_[2].inverse()});
  const BundleConfig to_the_end{.max_iterations = 100, .function_tolerance = 1e-12};
  for (const bool lenses : {false, true}) {
    BundleProblem::Lens unknown;
    unknown.prior_sigma << 0.005, 3, 3, 0.002, 0.001, 0.001, 0.01, 0.005, 0.0025, 0.001, 0.0005, 0.0002;
    if (lenses) p.lenses.assign(2, unknown);
    const BundleResult ours = solve_by_schur(p, to_the_end), other = test::solve_by_ceres(p, to_the_end);
    ASSERT_TRUE(ours.usable && other.usable);
    EXPECT_NEAR(ours.initial_cost, other.initial_cost, 1e-9 * other.initial_cost);
    EXPECT_NEAR(ours.final_cost, other.final_cost, 1e-6 * other.final_cost);
    for (std::size_t i = 0; i < poses_.size(); ++i) EXPECT_THAT(ours.poses[i], PoseNear(other.poses[i], 2e-4, 2e-4));
    for (std::size_t i = 0; i < ours.lenses.size(); ++i)
      EXPECT_THAT(ours.lenses[i].values, VectorNear(other.lenses[i].values, 0.02));
  }
}

// Many poses, of which each sees few points: most blocks of their system are empty.
TEST(BundleLongTest, AWholeRun) {
  constexpr int kPoses = 150;
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  BundleProblem p;
  p.cameras = {test::sim_camera()};
  std::vector<Rigid3> truth;
  for (int i = 0; i < kPoses; ++i) {
    truth.push_back(looking({0.3 * i, 0, 0}));
    Vector6d d = Vector6d::NullaryExpr([&](Eigen::Index k) { return (k < 3 ? 0.005 : 0.03) * normal(random); });
    p.poses.push_back({i < 2 ? truth.back() : retract(truth.back(), d), 0, i < 2});
  }
  for (int j = 0; j < 4 * kPoses; ++j) {
    const Eigen::Vector3d point(0.075 * j + 0.3 * normal(random), normal(random), 5 + normal(random));
    std::vector<int> seen;
    for (int i = 0; i < kPoses; ++i) {
      const Eigen::Vector3d x = truth[static_cast<std::size_t>(i)] * point;
      if (p.cameras[0].contains_raw(p.cameras[0].project(x))) seen.push_back(i);
    }
    if (seen.size() < 2) continue;
    for (const int i : seen) {
      const Eigen::Vector2d px = p.cameras[0].project(truth[static_cast<std::size_t>(i)] * point);
      p.observations.push_back(
          {i, static_cast<int>(p.points.size()), px + 0.2 * Eigen::Vector2d(normal(random), normal(random)), 0.2});
    }
    p.points.emplace_back(point + 0.05 * Eigen::Vector3d(normal(random), normal(random), normal(random)));
  }
  std::vector<int> told;
  const BundleResult r = solve_bundle(p, {.max_iterations = 30, .after_iteration = [&](int n) { told.push_back(n); }});
  ASSERT_TRUE(r.usable);
  EXPECT_EQ(std::ssize(told), r.iterations);
  EXPECT_NEAR(r.sigma_px, 0.2, 0.02);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_LT((r.poses[i].center() - truth[i].center()).norm(), 0.02 + 0.002 * static_cast<double>(i)) << i;
  }
}

}  // namespace
}  // namespace coslam::bundle_test
