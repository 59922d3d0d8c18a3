// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/triangulation.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <numbers>
#include <random>
#include <vector>

#include "tests/support/matchers.h"
#include "tests/support/sim_world.h"

namespace coslam::triangulation_test {
namespace {

using test::looking;
using test::VectorNear;

const CameraModel kCamera = test::sim_camera();
const Eigen::Vector3d kPoint(0.4, -0.3, 5);

std::vector<Rigid3> poses_along(double length_m, int count) {
  std::vector<Rigid3> poses;
  for (int i = 0; i < count; ++i) poses.push_back(looking({length_m * i / (count - 1), 0.1 * i / count, 0}, -0.02 * i));
  return poses;
}

std::vector<View> views_of(const std::vector<Rigid3>& poses, const Eigen::Vector3d& point) {
  std::vector<View> views;
  for (const Rigid3& pose : poses) views.push_back({&kCamera, pose, kCamera.project(pose * point)});
  return views;
}

TEST(Triangulate, ExactFromExactViews) {
  for (const int count : {2, 3, 20}) {
    const auto t = triangulate(views_of(poses_along(1, count), kPoint), 1.0, 0.01);
    ASSERT_EQ(t.status, TriangulationStatus::kOk);
    EXPECT_THAT(t.position, VectorNear(kPoint, 1e-9));
    EXPECT_LT(t.max_error_px, 1e-8);
  }
}

TEST(Triangulate, ErrorsAreOfTheRawImage) {
  CameraModel wide = kCamera;
  wide.distortion = DistortionModel::kEquidistant;
  wide.fx = wide.fy = 200;
  const Eigen::Vector3d point(6, 0.5, 3);  // 63 degrees off the axis
  std::vector<View> views = views_of(poses_along(1, 3), point);
  for (View& v : views) v.camera = &wide, v.undistorted_px = wide.project(v.cam_from_world * point);
  for (double dv : {-1.0, 1.0}) {
    View& v = views[dv < 0 ? 0 : 2];
    v.undistorted_px = *wide.undistorted_from_raw(wide.raw_from_undistorted(v.undistorted_px) + Eigen::Vector2d(0, dv));
  }
  const auto t = triangulate(views, 1.0, 0.01);
  ASSERT_EQ(t.status, TriangulationStatus::kOk);
  EXPECT_NEAR(t.max_error_px, 1.0, 0.15);
}

TEST(Triangulate, ParallaxIsTheWidestAngle) {
  // Seen from two places at +-45 degrees and one between.
  const std::vector<Rigid3> poses{looking({0, 0, 0}), looking({-5, 0, 0}, 0.5), looking({5, 0, 0}, -0.5)};
  const auto t = triangulate(views_of(poses, {0, 0, 5}), 1.0, 0.01);
  EXPECT_NEAR(t.parallax_rad, std::numbers::pi / 2, 1e-9);
}

TEST(Triangulate, CovarianceIsThatOfMonteCarlo) {
  constexpr double kSigma_px = 0.7;
  constexpr int kTrials = 4000;
  const std::vector<View> exact = views_of(poses_along(0.8, 4), kPoint);
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal(0, kSigma_px);
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double nees = 0;
  for (int i = 0; i < kTrials; ++i) {
    std::vector<View> views = exact;
    for (View& v : views) v.undistorted_px += Eigen::Vector2d(normal(random), normal(random));
    const auto t = triangulate(views, kSigma_px, 0.01);
    ASSERT_EQ(t.status, TriangulationStatus::kOk);
    const Eigen::Vector3d e = t.position - kPoint;
    scatter += e * e.transpose() / kTrials;
    sum += e / kTrials;
    nees += e.dot(t.covariance.ldlt().solve(e)) / kTrials;
  }
  const Eigen::Matrix3d predicted = triangulation_covariance(exact, kPoint, kSigma_px);
  // Whitened scatter is the unit matrix up to the sampling error of its entries, sqrt(2 / trials) = 0.022.
  const Eigen::LLT<Eigen::Matrix3d> llt(predicted);
  const Eigen::Matrix3d half = llt.matrixL().solve(scatter);
  const Eigen::Matrix3d white = llt.matrixL().solve(half.transpose());
  EXPECT_LT((white - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), 0.12);
  EXPECT_NEAR(nees, 3, 0.15);
  EXPECT_LT(sum.norm(), 0.1 * std::sqrt(predicted.trace()));
}

TEST(Triangulate, CovarianceFallsWithViewsAndRisesWithNoise) {
  const auto few = triangulate(views_of(poses_along(1, 2), kPoint), 1.0, 0.01);
  const auto many = triangulate(views_of(poses_along(1, 8), kPoint), 1.0, 0.01);
  const auto noisy = triangulate(views_of(poses_along(1, 2), kPoint), 3.0, 0.01);
  EXPECT_LT(many.covariance.trace(), few.covariance.trace());
  EXPECT_NEAR(noisy.covariance.trace(), 9 * few.covariance.trace(), 1e-6 * noisy.covariance.trace());
}

TEST(Triangulate, SaysWhyThereIsNoPoint) {
  const auto status = [](const std::vector<View>& views, double min_parallax_rad = 0.02) {
    return triangulate(views, 1.0, min_parallax_rad).status;
  };
  const std::vector<View> one = views_of({looking({0, 0, 0})}, kPoint);
  EXPECT_EQ(status({}), TriangulationStatus::kTooFewViews);
  EXPECT_EQ(status(one), TriangulationStatus::kTooFewViews);
  EXPECT_EQ(status({one[0], one[0]}), TriangulationStatus::kTooLittleParallax);
  // 5 cm to the side at 5 m: 0.01 rad.
  EXPECT_EQ(status(views_of({looking({0, 0, 0}), looking({0.05, 0, 0})}, kPoint)),
            TriangulationStatus::kTooLittleParallax);
  EXPECT_EQ(status(views_of({looking({0, 0, 0}), looking({0.05, 0, 0})}, kPoint), 0.005), TriangulationStatus::kOk);
}

TEST(Triangulate, APureTurnHasNoParallax) {
  std::vector<Rigid3> poses;
  for (int i = 0; i < 10; ++i) poses.push_back(looking({0, 0, 0}, 0.03 * i));
  std::vector<View> views = views_of(poses, kPoint);
  for (std::size_t i = 0; i < views.size(); ++i) views[i].undistorted_px.x() += i % 2 == 0 ? 0.3 : -0.3;
  EXPECT_NE(triangulate(views, 1.0, 0.02).status, TriangulationStatus::kOk);
}

TEST(Triangulate, RaysThatMeetBehindTheCameras) {
  // Diverging rays: the left camera sees it on the left, the right camera on the right.
  std::vector<View> views = views_of({looking({-0.5, 0, 0}), looking({0.5, 0, 0})}, {0, 0, 5});
  std::swap(views[0].undistorted_px, views[1].undistorted_px);
  EXPECT_EQ(triangulate(views, 1.0, 0.02).status, TriangulationStatus::kBehindCamera);
}

TEST(Triangulate, AnOutlierShowsInTheLargestError) {
  std::vector<View> views = views_of(poses_along(1, 6), kPoint);
  views[3].undistorted_px.y() += 30;
  const auto t = triangulate(views, 1.0, 0.02);
  EXPECT_EQ(t.status, TriangulationStatus::kOk);
  EXPECT_GT(t.max_error_px, 15);
}

TEST(ProjectWorld, JacobianByThePointNumerically) {
  const Rigid3 pose = looking({0.3, -0.2, 0.5}, 0.4, -0.2);
  Eigen::Vector2d px;
  Eigen::Matrix<double, 2, 3> j;
  ASSERT_TRUE(project_world(kCamera, pose, kPoint, &px, &j));
  EXPECT_THAT(px, VectorNear(kCamera.project(pose * kPoint), 1e-12));
  constexpr double h = 1e-5;
  for (int i = 0; i < 3; ++i) {
    Eigen::Vector2d plus, minus;
    ASSERT_TRUE(project_world(kCamera, pose, kPoint + h * Eigen::Vector3d::Unit(i), &plus));
    ASSERT_TRUE(project_world(kCamera, pose, kPoint - h * Eigen::Vector3d::Unit(i), &minus));
    EXPECT_THAT(j.col(i), VectorNear(((plus - minus) / (2 * h)).eval(), 1e-5));
  }
  EXPECT_FALSE(project_world(kCamera, looking({0, 0, 10}), kPoint, &px));
}

TEST(WorldRay, PointsFromTheCameraToThePoint) {
  const Rigid3 pose = looking({0.3, -0.2, 0.5}, 0.4, -0.2);
  const View view{&kCamera, pose, kCamera.project(pose * kPoint)};
  EXPECT_THAT(world_ray(view), VectorNear((kPoint - pose.center()).normalized(), 1e-12));
}

}  // namespace
}  // namespace coslam::triangulation_test
