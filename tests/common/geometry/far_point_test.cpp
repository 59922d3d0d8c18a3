// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/far_point.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>
#include <vector>

#include "common/geometry/pose_refinement.h"
#include "tests/support/matchers.h"
#include "tests/support/sim_world.h"

namespace coslam::far_point_test {
namespace {

using test::looking;
using test::PoseNear;
using test::VectorNear;

const CameraModel kCamera = test::sim_camera();
constexpr double kSigma_px = 0.5;

TEST(FarPoint, LiesOnItsRayAndCoversAllDepthsFromHalfOfItOn) {
  const Rigid3 pose = looking({0.4, -0.2, 0.3}, 0.3, -0.1);
  const Eigen::Vector2d px(500, 100);
  const std::vector<View> views{{&kCamera, pose, px}};
  const FarPoint far = far_point(views, 4.0, kSigma_px);
  EXPECT_NEAR((pose * far.position).z(), 4.0, 1e-12);
  EXPECT_THAT(kCamera.project(pose * far.position), VectorNear(px, 1e-9));
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(far.covariance);
  const Eigen::Vector3d ray = far.position - pose.center();
  EXPECT_NEAR(std::sqrt(axes.eigenvalues()[2]), ray.norm(), 1e-9);
  EXPECT_NEAR(std::abs(axes.eigenvectors().col(2).dot(ray.normalized())), 1, 1e-12);
  for (const int i : {0, 1}) {
    EXPECT_NEAR(std::sqrt(axes.eigenvalues()[i]), kSigma_px * ray.norm() / kCamera.focal_px(), 1e-9);
  }
}

// What a camera at `now` sees of the things that one at `first` saw, all taken to be `guess` far away.
std::vector<PointObservation> seen_again(const Rigid3& first, const Rigid3& now, double guess, unsigned seed) {
  static const test::SimWorld world({.seed = 7, .points = 3000});
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0, 0.3);
  const auto seen = [&](const Rigid3& pose, int i) -> std::optional<Eigen::Vector2d> {
    const Eigen::Vector3d x = pose * world.position(i);
    if (x.z() < 0.5 || !kCamera.contains_raw(kCamera.project(x))) return std::nullopt;
    return kCamera.project(x) + Eigen::Vector2d(noise(random), noise(random));
  };
  std::vector<PointObservation> out;
  for (int i = 0; i < world.size() && out.size() < 150; ++i) {
    const auto then = seen(first, i), again = seen(now, i);
    if (!then || !again) continue;
    const std::vector<View> views{{&kCamera, first, *then}};
    const FarPoint far = far_point(views, guess, kSigma_px);
    out.push_back({far.position, far.covariance, *again, true});
  }
  return out;
}

// Whatever was guessed; with a standard deviation that says how far off it may be.
TEST(FarPoint, LearnsItsDepthFromItsParallax) {
  std::mt19937_64 random(2);
  std::normal_distribution<double> noise(0, kSigma_px);
  const Eigen::Vector3d place(0.5, -0.3, 8);
  double sum2 = 0;
  int n = 0;
  for (const double guess : {3.0, 8.0, 20.0}) {
    for (int trial = 0; trial < 100; ++trial) {
      std::vector<View> views;
      for (int i = 0; i < 6; ++i) {
        const Rigid3 pose = looking({0.1 * i, 0.02 * i, 0.05 * i}, 0.01 * i);
        const Eigen::Vector2d px = kCamera.project(pose * place) + Eigen::Vector2d(noise(random), noise(random));
        views.push_back({&kCamera, pose, px});
      }
      const FarPoint far = far_point(views, guess, kSigma_px);
      EXPECT_LT(far.sigma, 0.3 / 8);
      const double error = (far.inverse_depth - 1.0 / 8) / far.sigma;
      sum2 += error * error;
      ++n;
    }
  }
  EXPECT_LT(sum2 / n, 6) << "the noise of the first view, which all others share, is not counted";
  EXPECT_GT(sum2 / n, 0.5);
}

TEST(FarPoint, WhatHasNoParallaxIsFarAway) {
  const Eigen::Vector3d ray(0.1, 0.05, 1);
  std::vector<View> views;
  for (int i = 0; i < 6; ++i) {
    const Rigid3 pose = looking({0.2 * i, 0, 0});
    views.push_back({&kCamera, pose, kCamera.project(pose.rotation * ray)});
  }
  const FarPoint far = far_point(views, 4.0, kSigma_px);
  EXPECT_GT((views.front().cam_from_world * far.position).z(), 50);
}

TEST(FarPoint, HoldsACameraThatTurnsOnTheSpot) {
  const Rigid3 first = looking({0, 0, 0});
  for (const double guess : {1.0, 5.0, 50.0}) {
    const Rigid3 now = looking({0, 0, 0}, 0.25, 0.05);
    const auto observations = seen_again(first, now, guess, 3);
    const PoseResult r = refine_pose(kCamera, observations, looking({0, 0, 0}, 0.2), {});
    ASSERT_EQ(r.status, PoseStatus::kOk);
    EXPECT_THAT(r.cam_from_world, PoseNear(now, 0.003, 0.005 * guess)) << guess;
  }
}

TEST(FarPoint, LeavesTheWayThatTheCameraWentToOthers) {
  const Rigid3 first = looking({0, 0, 0}), now = looking({0.4, 0, 0}, 0.1);
  std::vector<PointObservation> observations = seen_again(first, now, 3.0, 5);
  // A few points whose places are known.
  const test::SimWorld world({.seed = 7, .points = 3000});
  int known = 0;
  for (int i = 0; known < 20; ++i) {
    const Eigen::Vector3d x = now * world.position(i);
    if (x.z() < 0.5 || !kCamera.contains_raw(kCamera.project(x))) continue;
    observations.push_back({world.position(i), 1e-6 * Eigen::Matrix3d::Identity(), kCamera.project(x)});
    ++known;
  }
  const PoseResult r = refine_pose(kCamera, observations, looking({0.36, 0, 0}, 0.08), {});
  ASSERT_EQ(r.status, PoseStatus::kOk);
  EXPECT_THAT(r.cam_from_world, PoseNear(now, 0.002, 0.01));
}

}  // namespace
}  // namespace coslam::far_point_test
