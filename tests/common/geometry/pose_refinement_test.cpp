// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/pose_refinement.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "common/geometry/robust.h"
#include "tests/support/matchers.h"
#include "tests/support/sim_world.h"

namespace coslam::pose_refinement_test {
namespace {

using test::looking;
using test::PoseNear;

double median(std::vector<double> values) { return upper_median(values); }

const CameraModel kCamera = test::sim_camera();
const Rigid3 kTruth = looking({0.4, -0.2, 0.3}, 0.1, -0.05);

class Random {
 public:
  explicit Random(unsigned seed) : random_(seed) {}
  double gauss() { return normal_(random_); }
  double uniform(double low, double high) { return std::uniform_real_distribution<>(low, high)(random_); }
  Eigen::Vector3d vector(double sigma) { return sigma * Eigen::Vector3d(gauss(), gauss(), gauss()); }

 private:
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
};

struct Noise {
  double px = 0;
  double point_m = 0;
  double outliers = 0;
};

// Points of the room that the true pose sees.
std::vector<PointObservation> observe(int count, const Noise& noise, unsigned seed) {
  Random random(seed);
  static const test::SimWorld world({.seed = 4, .points = 2000});
  std::vector<PointObservation> out;
  for (int i = 0; i < world.size() && static_cast<int>(out.size()) < count; ++i) {
    const Eigen::Vector3d in_cam = kTruth * world.position(i);
    if (in_cam.z() < 0.5 || !kCamera.contains_raw(kCamera.project(in_cam))) continue;
    PointObservation& o = out.emplace_back();
    o.point_in_world = world.position(i) + random.vector(noise.point_m);
    o.point_covariance = noise.point_m * noise.point_m * Eigen::Matrix3d::Identity();
    o.undistorted_px = kCamera.project(in_cam) + noise.px * Eigen::Vector2d(random.gauss(), random.gauss());
    if (random.uniform(0, 1) < noise.outliers) {
      o.undistorted_px = {random.uniform(0, kCamera.width_px), random.uniform(0, kCamera.height_px)};
    }
  }
  return out;
}

// Turned by `angle_rad` about a random axis and moved by `apart_m`.
Rigid3 off(double angle_rad, double apart_m, unsigned seed) {
  Random random(seed);
  const Eigen::Quaterniond turn = so3_exp(angle_rad * random.vector(1).normalized());
  const Eigen::Quaterniond rotation = (turn * kTruth.rotation).normalized();
  return {rotation, -(rotation * (kTruth.center() + apart_m * random.vector(1).normalized()))};
}

TEST(RefinePose, ConvergesFromFiveDegreesAndTwentyCentimetres) {
  const auto observations = observe(120, {.px = 0.5}, 1);
  for (unsigned seed = 0; seed < 30; ++seed) {
    const PoseResult r = refine_pose(kCamera, observations, off(0.0873, 0.2, seed), {});
    ASSERT_EQ(r.status, PoseStatus::kOk) << seed;
    EXPECT_THAT(r.cam_from_world, PoseNear(kTruth, 0.002, 0.01)) << seed;
    EXPECT_GE(r.inliers, 115) << seed;
  }
}

TEST(RefinePose, ConvergesFromAPredictionThirtyPixelsOff) {
  const auto observations = observe(120, {.px = 0.5, .point_m = 0.01}, 2);
  for (unsigned seed = 0; seed < 30; ++seed) {
    const PoseResult r = refine_pose(kCamera, observations, off(30 / kCamera.fx, 0, seed), {});
    ASSERT_EQ(r.status, PoseStatus::kOk) << seed;
    EXPECT_THAT(r.cam_from_world, PoseNear(kTruth, 0.002, 0.01)) << seed;
  }
}

TEST(RefinePose, StandsFortyPercentOutliers) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    const auto observations = observe(150, {.px = 0.5, .outliers = 0.4}, 10 + seed);
    const PoseResult r = refine_pose(kCamera, observations, off(0.02, 0.05, seed), {});
    ASSERT_EQ(r.status, PoseStatus::kOk) << seed;
    EXPECT_THAT(r.cam_from_world, PoseNear(kTruth, 0.002, 0.01)) << seed;
    // Who is an inlier is told rightly: those near their true place, and no other.
    for (std::size_t i = 0; i < observations.size(); ++i) {
      const double error_px =
          (kCamera.project(kTruth * observations[i].point_in_world) - observations[i].undistorted_px).norm();
      if (error_px < 0.5 || error_px > 12) {
        EXPECT_EQ(r.is_inlier[i], error_px < 0.5) << error_px;
      }
    }
    EXPECT_EQ(r.inliers, std::count(r.is_inlier.begin(), r.is_inlier.end(), true));
  }
}

TEST(RefinePose, MeasuresTheScaleOfTheResiduals) {
  EXPECT_NEAR(refine_pose(kCamera, observe(400, {.px = 1.0}, 3), kTruth, {}).sigma_px, 1.0, 0.15);
  EXPECT_NEAR(refine_pose(kCamera, observe(400, {.px = 2.0}, 3), kTruth, {}).sigma_px, 2.0, 0.3);
  // Never below the floor, never above what is believed.
  EXPECT_DOUBLE_EQ(refine_pose(kCamera, observe(100, {}, 3), kTruth, {}).sigma_px,
                   PoseRefinementConfig{}.sigma_floor_px);
  EXPECT_LE(refine_pose(kCamera, observe(400, {.px = 9}, 3), kTruth, {}).sigma_px, 3.0);
}

// NEES of the six degrees of freedom over many trials: 6 when the covariance is right.
double mean_nees(const Noise& noise, int trials) {
  double sum = 0;
  for (int i = 0; i < trials; ++i) {
    const auto observations = observe(100, noise, 100 + static_cast<unsigned>(i));
    const PoseResult r = refine_pose(kCamera, observations, kTruth, {});
    EXPECT_EQ(r.status, PoseStatus::kOk);
    const Vector6d e = local(r.cam_from_world, kTruth);
    sum += e.dot(r.covariance.inverse() * e);
  }
  return sum / trials;
}

// The mean of 300 chi-square variables with 6 degrees of freedom has the standard deviation 0.2. The estimate is a
// robust one with a measured scale: within a quarter of 6.
TEST(RefinePose, CovarianceIsConsistentForPixelNoise) { EXPECT_NEAR(mean_nees({.px = 1.0}, 300), 6, 1.5); }

// Of a lens with 150 degrees from corner to corner, whose noise is even in the raw image. In the undistorted one, where
// a residual near the edge is up to 14 times as large as in the middle, the pose would follow the edge.
TEST(RefinePose, CovarianceIsConsistentForAWideLens) {
  CameraModel camera = kCamera;
  camera.distortion = DistortionModel::kEquidistant;
  camera.fx = camera.fy = 0.5 * std::hypot(camera.width_px, camera.height_px) / 1.309;
  constexpr int kTrials = 200;
  double nees = 0, inliers = 0;
  for (unsigned seed = 0; seed < kTrials; ++seed) {
    Random random(seed);
    std::vector<PointObservation> observations;
    while (observations.size() < 150) {
      const Eigen::Vector2d raw(random.uniform(0, camera.width_px - 1), random.uniform(0, camera.height_px - 1));
      const auto seen = camera.undistorted_from_raw(raw);
      const auto noisy = camera.undistorted_from_raw(raw + 0.8 * Eigen::Vector2d(random.gauss(), random.gauss()));
      if (!seen || !noisy) continue;
      const Eigen::Vector3d ray = camera.normalized_from_pixel(*seen).homogeneous();
      const Eigen::Vector3d p_in_world = kTruth.inverse() * (random.uniform(2, 6) * ray.normalized());
      observations.push_back({p_in_world, Eigen::Matrix3d::Zero(), *noisy});
    }
    const PoseResult r = refine_pose(camera, observations, off(0.02, 0.05, seed), {});
    ASSERT_EQ(r.status, PoseStatus::kOk);
    const Vector6d e = local(r.cam_from_world, kTruth);
    nees += e.dot(r.covariance.inverse() * e) / kTrials;
    inliers += r.inliers / 150.0 / kTrials;
    EXPECT_NEAR(r.sigma_px, 0.8, 0.25);
  }
  EXPECT_NEAR(nees, 6, 1.5);
  EXPECT_GT(inliers, 0.97);
}

// The brighter part of the error is the points' own: the scale of the rest is then less well known.
TEST(RefinePose, CovarianceIsConsistentForUncertainPoints) {
  const double nees = mean_nees({.px = 0.7, .point_m = 0.02}, 300);
  EXPECT_GT(nees, 3.5);
  EXPECT_LT(nees, 8);
}

// Without noise all weights are 1 and the scale is the floor, so that the covariance tells the Jacobian of the
// residuals.
TEST(RefinePose, JacobianNumericallyThroughRetract) {
  const auto observations = observe(60, {}, 5);
  const PoseResult r = refine_pose(kCamera, observations, kTruth, {.sigma_px = 3, .sigma_floor_px = 0.5});
  ASSERT_EQ(r.status, PoseStatus::kOk);
  constexpr double h = 1e-6;
  Matrix6d information = Matrix6d::Zero();
  for (const PointObservation& o : observations) {
    Eigen::Matrix<double, 2, 6> j;
    for (int i = 0; i < 6; ++i) {
      const Vector6d d = h * Vector6d::Unit(i);
      j.col(i) = (kCamera.project(retract(kTruth, d) * o.point_in_world) -
                  kCamera.project(retract(kTruth, -d) * o.point_in_world)) /
                 (2 * h);
    }
    information += j.transpose() * j / (0.5 * 0.5);
  }
  const Matrix6d product = information * r.covariance;
  EXPECT_LT((product - Matrix6d::Identity()).norm(), 1e-4);
}

TEST(RefinePose, TooFewPointsIsAReason) {
  const auto observations = observe(5, {}, 6);
  EXPECT_EQ(refine_pose(kCamera, observations, kTruth, {}).status, PoseStatus::kTooFewPoints);
  EXPECT_EQ(refine_pose(kCamera, {}, kTruth, {}).status, PoseStatus::kTooFewPoints);
}

TEST(RefinePose, PointsBehindTheCameraAreNoInliers) {
  const auto observations = observe(100, {.px = 0.5}, 7);
  const Rigid3 turned = looking(kTruth.center(), 3.1);
  EXPECT_EQ(refine_pose(kCamera, observations, turned, {}).status, PoseStatus::kTooFewInliers);
}

TEST(RefinePose, ContradictionIsNoPose) {
  Random random(8);
  auto observations = observe(100, {}, 8);
  for (auto& o : observations) o.undistorted_px = {random.uniform(0, 640), random.uniform(0, 480)};
  const PoseResult r = refine_pose(kCamera, observations, kTruth, {});
  // Points at random places fit no pose: if one comes out, it stands on few of them.
  EXPECT_TRUE(r.status != PoseStatus::kOk || r.inliers < 15) << r.inliers;
}

TEST(RefinePose, PointsOnALineFixNoPose) {
  std::vector<PointObservation> observations(30);
  for (int i = 0; i < 30; ++i) {
    PointObservation& o = observations[static_cast<std::size_t>(i)];
    o.point_in_world = Eigen::Vector3d(-1, 0.5, 5) + 0.1 * i * Eigen::Vector3d(1, -0.3, 0.4);
    o.undistorted_px = kCamera.project(kTruth * o.point_in_world);
  }
  EXPECT_EQ(refine_pose(kCamera, observations, kTruth, {}).status, PoseStatus::kDegenerate);
}

TEST(RefinePose, OnePlaceFixesNoPose) {
  std::vector<PointObservation> observations(30);
  for (PointObservation& o : observations) {
    o.point_in_world = {0.2, 0.1, 5};
    o.undistorted_px = kCamera.project(kTruth * o.point_in_world);
  }
  EXPECT_EQ(refine_pose(kCamera, observations, kTruth, {}).status, PoseStatus::kDegenerate);
}

TEST(HullFraction, OfKnownShapes) {
  const std::vector<Eigen::Vector2d> corners{{0, 0}, {640, 0}, {640, 480}, {0, 480}};
  EXPECT_NEAR(hull_fraction(corners, kCamera), 1.0, 1e-12);
  EXPECT_NEAR(hull_fraction({{0, 0}, {640, 0}, {0, 480}}, kCamera), 0.5, 1e-12);
  // Points within, at corners again and on edges change nothing.
  EXPECT_NEAR(hull_fraction({{100, 100}, {0, 0}, {320, 0}, {640, 0}, {0, 480}, {0, 0}, {0, 240}}, kCamera), 0.5, 1e-12);
  // Undistorted pixels may lie outside the image; a fraction stays one.
  EXPECT_EQ(hull_fraction({{-640, -480}, {1280, -480}, {1280, 960}, {-640, 960}}, kCamera), 1.0);
}

TEST(HullFraction, NothingFromALine) {
  EXPECT_EQ(hull_fraction({}, kCamera), 0);
  EXPECT_EQ(hull_fraction({{1, 2}, {300, 200}}, kCamera), 0);
  EXPECT_EQ(hull_fraction({{0, 0}, {10, 20}, {20, 40}, {30, 60}}, kCamera), 0);
  EXPECT_EQ(hull_fraction({{7, 7}, {7, 7}, {7, 7}, {7, 7}}, kCamera), 0);
}

// Two cameras on one body that look 90 degrees apart; what each sees alone is too little.
TEST(RefineRigPose, TwoCamerasWithFewPointsEachTellOnePose) {
  const Rigid3 right_from_rig{so3_exp({0, -1.57, 0}), {0.1, 0.05, -0.02}};
  const RigView rig[] = {{&kCamera, Rigid3()}, {&kCamera, right_from_rig}};
  const test::SimWorld world({.seed = 4, .layout = test::Layout::kAround, .points = 2000});
  std::vector<PointObservation> seen;
  for (int camera = 0; camera < 2; ++camera) {
    int n = 0;
    for (int i = 0; i < world.size() && n < 5; i += 7) {
      const Eigen::Vector3d in_cam = rig[camera].cam_from_rig * (kTruth * world.position(i));
      if (in_cam.z() < 0.5 || !kCamera.contains_raw(kCamera.project(in_cam))) continue;
      seen.push_back(
          {.point_in_world = world.position(i), .undistorted_px = kCamera.project(in_cam), .camera = camera});
      ++n;
    }
    ASSERT_EQ(n, 5);
  }
  Vector6d off;
  off << 0.02, -0.03, 0.01, 0.1, -0.05, 0.08;
  const PoseResult r = refine_rig_pose(rig, seen, retract(kTruth, off), {});
  ASSERT_EQ(r.status, PoseStatus::kOk);
  EXPECT_EQ(r.inliers, 10);
  EXPECT_THAT(r.cam_from_world, PoseNear(kTruth, 1e-6, 1e-6));
  const PoseResult alone = refine_pose(kCamera, std::span(seen).first(5), retract(kTruth, off), {});
  EXPECT_EQ(alone.status, PoseStatus::kTooFewPoints);
}

TEST(RefineRigPose, OneCameraAtTheBodyIsRefinePose) {
  const auto seen = observe(80, {.px = 0.5, .point_m = 0.01, .outliers = 0.1}, 3);
  const RigView alone[] = {{&kCamera, Rigid3()}};
  Vector6d off = Vector6d::Constant(0.01);
  const PoseResult a = refine_pose(kCamera, seen, retract(kTruth, off), {});
  const PoseResult b = refine_rig_pose(alone, seen, retract(kTruth, off), {});
  EXPECT_EQ(a.cam_from_world.translation, b.cam_from_world.translation);
  EXPECT_EQ(a.inliers, b.inliers);
  EXPECT_EQ(a.covariance, b.covariance);
}

// Points in a corner of the image hold a pose poorly; what is known beforehand holds the rest.
TEST(RefinePose, APriorCountsBesideTheObservations) {
  std::vector<double> with_m, without_m, values;
  for (unsigned seed = 0; seed < 40; ++seed) {
    auto observations = observe(2000, {.px = 0.5}, seed);
    std::erase_if(observations, [](const PointObservation& o) {
      return o.undistorted_px.x() > kCamera.width_px / 4 || o.undistorted_px.y() > kCamera.height_px / 4;
    });
    observations.resize(std::min<std::size_t>(observations.size(), 15));
    PosePrior prior{off(0.003, 0.01, seed), Matrix6d::Zero()};
    prior.covariance.diagonal() << 3e-6, 3e-6, 3e-6, 3.3e-5, 3.3e-5, 3.3e-5;
    const auto error_m = [](const PoseResult& r) { return (r.cam_from_world.center() - kTruth.center()).norm(); };
    const PoseResult poor = refine_pose(kCamera, observations, prior.cam_from_world, {});
    const PoseResult r = refine_pose(kCamera, observations, prior.cam_from_world, {.prior = prior});
    ASSERT_EQ(r.status, PoseStatus::kOk);
    without_m.push_back(error_m(poor));
    with_m.push_back(error_m(r));
    const Vector6d error = local(r.cam_from_world, kTruth);
    values.push_back(error.dot(r.covariance.inverse() * error));
  }
  EXPECT_LT(median(with_m), 0.012);
  EXPECT_LT(median(with_m), 0.5 * median(without_m));
  EXPECT_LT(median(values), 9);
}

TEST(RefinePose, AWrongPriorDoesNotStandAgainstManyPoints) {
  const auto observations = observe(120, {.px = 0.5}, 1);
  PosePrior prior{off(0.05, 0.2, 3), 1e-6 * Matrix6d::Identity()};
  const PoseResult r = refine_pose(kCamera, observations, prior.cam_from_world, {.prior = prior});
  ASSERT_EQ(r.status, PoseStatus::kOk);
  EXPECT_THAT(r.cam_from_world, PoseNear(kTruth, 0.003, 0.01));
}

}  // namespace
}  // namespace coslam::pose_refinement_test
