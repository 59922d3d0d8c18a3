// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/associate/verify.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <random>

#include "tests/support/matchers.h"
#include "tests/support/sim_map.h"

namespace coslam::verify_test {
namespace {

using test::looking;
using test::VectorNear;

constexpr CameraId kCam0(0), kCam1(1);
const CameraModel kCamera = test::sim_camera();

// A point after the filter took one more view of it.
MapPoint updated(MapPoint p, const Rigid3& cam_from_world, const Eigen::Vector2d& undistorted_px, double sigma_px) {
  const PointEstimate now = kalman_update(p, kCamera, cam_from_world, undistorted_px, sigma_px);
  p.position = now.position;
  p.covariance = now.covariance;
  return p;
}

MapPoint point_at(const Eigen::Vector3d& position, const Eigen::Matrix3d& covariance) {
  MapPoint p;
  p.id = PointId(1);
  p.position = position;
  p.covariance = covariance;
  return p;
}

TEST(GateDistance, IsMahalanobis) {
  // Straight ahead at 4.17 m a centimetre is a pixel: a standard deviation of 2 cm is 2 px.
  const MapPoint p = point_at({0, 0, 4.17}, 4e-4 * Eigen::Matrix3d::Identity());
  const auto d2 = [&](const Eigen::Vector2d& px, double sigma_px) {
    return gate_distance2({p.position, p.covariance}, kCamera, Rigid3(), px, sigma_px);
  };
  EXPECT_NEAR(*d2({320, 240}, 1.5), 0, 1e-12);
  EXPECT_NEAR(*d2({325, 240}, 1.5), 25 / (4 + 2.25), 1e-9);
  EXPECT_NEAR(*d2({323, 236}, 0), 25.0 / 4, 1e-9);
  EXPECT_FALSE(gate_distance2({p.position, p.covariance}, kCamera, looking({0, 0, 10}), {320, 240}, 1.0))
      << "behind the camera";
}

TEST(KalmanUpdate, IsTheBatchLeastSquaresOfPriorAndObservations) {
  constexpr double kSigma_px = 0.5;
  const Eigen::Vector3d truth(0.4, -0.2, 5);
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  Eigen::Matrix3d covariance = Eigen::Vector3d(1e-4, 1e-4, 4e-3).asDiagonal();
  MapPoint p = point_at(truth + Eigen::Vector3d(0.005, -0.008, 0.04), covariance);

  Eigen::Matrix3d information = covariance.inverse();
  Eigen::Vector3d weighted = information * p.position;  // linear in the point: J is taken at truth
  for (int i = 0; i < 20; ++i) {
    const Rigid3 pose = looking({0.1 * i, 0.02 * i, 0}, -0.01 * i);
    Eigen::Vector2d px;
    Eigen::Matrix<double, 2, 3> j;
    ASSERT_TRUE(project_world(kCamera, pose, truth, &px, &j));
    const Eigen::Vector2d seen = px + kSigma_px * Eigen::Vector2d(normal(random), normal(random));
    p = updated(p, pose, seen, kSigma_px);
    information += j.transpose() * j / (kSigma_px * kSigma_px);
    weighted += j.transpose() * (seen - px + j * truth) / (kSigma_px * kSigma_px);
  }
  const Eigen::Matrix3d batch_covariance = information.inverse();
  const Eigen::Vector3d batch = batch_covariance * weighted;
  EXPECT_THAT(p.position, VectorNear(batch, 0.05 * std::sqrt(batch_covariance.trace())));
  EXPECT_LT((p.covariance - batch_covariance).norm(), 0.03 * batch_covariance.norm());
}

TEST(KalmanUpdate, CovarianceStaysSymmetricPositiveDefinite) {
  MapPoint p = point_at({0.4, -0.2, 5}, 100 * Eigen::Matrix3d::Identity());
  for (int i = 0; i < 100000; ++i) p = updated(p, looking({0.5 * (i % 3), 0, 0}), {353, 223}, 0.01);
  EXPECT_LT((p.covariance - p.covariance.transpose()).norm(), 1e-6 * p.covariance.norm());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(p.covariance);
  EXPECT_GT(eigen.eigenvalues().minCoeff(), 0);
  EXPECT_TRUE(p.position.allFinite());
}

TEST(KalmanUpdate, BehindTheCameraNothingHappens) {
  const MapPoint p = updated(point_at({0, 0, 5}, Eigen::Matrix3d::Identity()), looking({0, 0, 10}), {320, 240}, 1);
  EXPECT_EQ(p.position, Eigen::Vector3d(0, 0, 5));
  EXPECT_EQ(p.covariance, Eigen::Matrix3d::Identity());
}

class VerifyTest : public testing::Test {
 protected:
  explicit VerifyTest(const std::vector<test::CameraPath>& paths = test::paths_side_by_side(2)) : sim_(world_, paths) {
    sim_.advance(2);
    sim_.add_points(0.003);  // less than what the tracker's noise makes of a view
  }
  VerifyReport step() {
    sim_.advance();
    return verify(sim_.edit, sim_.set, config_);
  }
  // A map point with tracks in both cameras.
  const MapPoint& shared_point() const {
    for (const auto& [id, p] : sim_.map.points()) {
      if (p.bound.size() == 2) return p;
    }
    return sim_.map.points().begin()->second;
  }
  const ServerTrack& track(CameraId camera, const BoundTrack& b) { return sim_.map.camera(camera).tracks.at(b.track); }

  const VerifyConfig config_;
  const test::SimWorld world_{{}};
  test::SimMap sim_;
};

TEST_F(VerifyTest, TruePointsStayInside) {
  int inside = 0, outside = 0, updated = 0;
  for (int i = 0; i < 60; ++i) {
    const VerifyReport report = step();
    inside += report.inside;
    outside += report.outside;
    updated += report.updated;
  }
  EXPECT_GT(inside, 5000);
  EXPECT_LT(outside, 0.001 * inside);
  EXPECT_GT(updated, 500) << "the cameras move";
  const MapPoint& p = shared_point();
  EXPECT_EQ(p.last_seen, sim_.set.id);
  EXPECT_EQ(p.last_ns, sim_.set.t_ns);
  EXPECT_GT(p.views, 60U);
}

TEST_F(VerifyTest, APointThatIsElsewhereFailsEverywhere) {
  const MapPoint& p = shared_point();
  sim_.shift(p, {0.4, 0, 0});
  const Eigen::Vector3d place = p.position;
  for (int i = 1; i <= sim_.map.config().failures; ++i) {
    EXPECT_GE(step().outside, 2);
    ASSERT_EQ(p.bound.size(), 2U) << "others say what comes of it";
    for (const BoundTrack& b : p.bound) EXPECT_EQ(track(b.camera, b).gate_failures, i);
  }
  EXPECT_EQ(p.position, place) << "it is not dragged along";
}

TEST_F(VerifyTest, OneBadStepIsForgiven) {
  const MapPoint& p = shared_point();
  const BoundTrack b = p.bound[0];
  sim_.look();
  sim_.seen(kCam0, sim_.world_point(p))->undistorted_px += Eigen::Vector2f(25, 0);
  sim_.take();
  sim_.place_truly();
  verify(sim_.edit, sim_.set, config_);
  EXPECT_EQ(track(kCam0, b).gate_failures, 1);
  step();
  EXPECT_EQ(track(kCam0, b).gate_failures, 0);
  EXPECT_EQ(p.bound.size(), 2U);
}

TEST_F(VerifyTest, AFrameWithoutAPoseJudgesNothing) {
  sim_.ingest();
  sim_.place_truly(kCam1);
  const MapPoint& p = shared_point();
  const std::uint32_t views = p.views;
  verify(sim_.edit, sim_.set, config_);
  EXPECT_EQ(p.views, views + 1) << "by the other camera only";
}

TEST_F(VerifyTest, UpdatesBringAPointCloser) {
  std::vector<double> before, after;
  const auto error = [&](const MapPoint& p) { return (p.position - world_.position(sim_.world_point(p))).norm(); };
  for (const auto& [id, p] : sim_.map.points()) {
    sim_.edit.move_point(p, p.position + Eigen::Vector3d(0.01, -0.01, 0.03), 1e-3 * Eigen::Matrix3d::Identity());
    before.push_back(error(p));
  }
  for (int i = 0; i < 90; ++i) step();
  for (const auto& [id, p] : sim_.map.points()) {
    if (!p.bound.empty()) after.push_back(error(p));
  }
  EXPECT_LT(test::median(after), 0.8 * test::median(before));
}

class Hovering : public VerifyTest {
 protected:
  explicit Hovering(int cameras = 2) : VerifyTest(paths(cameras)) {}
  static std::vector<test::CameraPath> paths(int cameras) {
    std::vector<test::CameraPath> out;
    for (int i = 0; i < cameras; ++i) out.push_back(test::still_path(looking({0.5 * i - 1, 0, 0})));
    return out;
  }
};

TEST_F(Hovering, RepeatedObservationsTeachNothing) {
  const double before = shared_point().covariance.trace();
  for (int i = 0; i < 50; ++i) EXPECT_EQ(step().updated, 0);
  EXPECT_EQ(shared_point().covariance.trace(), before);
}

class ManyHovering : public Hovering {
 protected:
  ManyHovering() : Hovering(6) {}
};

TEST_F(ManyHovering, RepeatedObservationsTeachNothingHoweverManyCameras) {
  for (int i = 0; i < 20; ++i) ASSERT_EQ(step().updated, 0) << i;
}

TEST_F(VerifyTest, ThePastIsAsFarBackAsItIsTrusted) {
  for (int i = 0; i < 8; ++i) step();
  const BoundTrack b = shared_point().bound[0];
  const auto views = [&](Past past, std::size_t most = 100) {
    return newest_views(sim_.map.camera(b.camera), track(b.camera, b), most, past).size();
  };
  EXPECT_EQ(views(Past::kTrusted), 10U);
  EXPECT_EQ(views(Past::kTrusted, 4), 4U);
  sim_.edit.distrust_before(track(b.camera, b), SetId(sim_.set.id.value - 2));
  EXPECT_EQ(views(Past::kTrusted), 3U);
  EXPECT_EQ(views(Past::kAll), 10U);
}

}  // namespace
}  // namespace coslam::verify_test
