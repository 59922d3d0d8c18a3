// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/map/point_pen.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

#include "tests/server/estimator/map/shared_point.h"
#include "tests/support/map_checks.h"
#include "tests/support/matchers.h"
#include "tests/support/sim_map.h"

// Corner cases of verbs on points. What each does is in edit_test.cpp and map_points_test.cpp.
namespace coslam::point_pen_test {
namespace {

using test::VectorNear;

constexpr CameraId kCam0(0), kCam1(1);

class PointPenTest : public test::SharedPointTest {
 protected:
  PointPenTest() : SharedPointTest(true) {}
};

TEST_F(PointPenTest, ATransformTurnsAndScalesTheCovarianceToo) {
  const Eigen::Matrix3d covariance = Eigen::Vector3d(1, 4, 9).asDiagonal();
  const MapPoint& p = edit_.create_point(sim_.id, {1, 2, 3}, covariance, PointPhase::kStatic, Why::kTwoCamerasNow);
  const Similarity3 quarter{
      2, Eigen::Quaterniond(Eigen::AngleAxisd(EIGEN_PI / 2, Eigen::Vector3d::UnitZ())), {0, 0, 1}};
  edit_.transform_point(p, quarter);
  EXPECT_THAT(p.position, VectorNear(Eigen::Vector3d(-4, 2, 7), 1e-12));
  const Eigen::Matrix3d expected = Eigen::Vector3d(16, 4, 36).asDiagonal();
  EXPECT_LT((p.covariance - expected).norm(), 1e-9);
}

TEST_F(PointPenTest, NoPointIsFusedWithItself) {
  const MapPoint& p = sim_.add_point(shared_);
  const MapEdit before = edit_;
  edit_.fuse(p.id, p.id, Why::kOneCorner);
  test::expect_same(sim_.map, before.map());
  EXPECT_EQ(edit_.journal().events().size(), before.journal().events().size());
}

TEST_F(PointPenTest, AFusedPointWasSeenWheneverOneOfTheTwoWas) {
  const PointId old = sim_.create({0, 0, 5}).id;
  edit_.see(*sim_.map.find(old));
  const TimeNs first_ns = sim_.set.t_ns;
  sim_.advance(40);
  int followed = 0;
  while (!sim_.all_follow(followed)) ++followed;
  const MapPoint& fresh = sim_.add_point(followed);
  edit_.see(fresh);
  edit_.see(fresh);
  edit_.fuse(old, fresh.id, Why::kOneCorner);
  const MapPoint& p = *sim_.map.find(old);
  EXPECT_EQ(p.views, 3U);
  EXPECT_EQ(p.first_ns, first_ns);
  EXPECT_EQ(p.last_ns, sim_.set.t_ns);
  EXPECT_EQ(p.last_seen, sim_.set.id);
  EXPECT_FALSE(sim_.map.untracked_points().contains(old)) << "it has the tracks of the other";
  EXPECT_EQ(sim_.map.recent_points(), std::vector<const MapPoint*>{&p});
  test::expect_consistent(sim_.map);
}

TEST_F(PointPenTest, PatchesOfAPointThatIsGoneNeedNoThinning) {
  const MapPoint& gone = sim_.add_point(shared_);
  const PointId id = gone.id;
  edit_.remove_point(gone, Why::kTooFewViews);
  edit_.thin_patches(1);
  EXPECT_EQ(sim_.map.find(id), nullptr);
  const MapPoint& p = sim_.add_point(shared_);
  edit_.keep_newest_patches(p, 100);
  EXPECT_EQ(p.patches.size(), 2U) << "it has fewer than may stay";
  edit_.thin_patches(1);
  EXPECT_EQ(p.patches.size(), 1U);
}

TEST_F(PointPenTest, ATrialIsOfOneMap) {
  const MapId other = edit_.new_map(Why::kStartedAlone, 1);
  const MapPoint &own = sim_.create(sim_.id, {0, 0, 5}), &apart = sim_.create(other, {0, 0, 5}),
                 &moving = sim_.create({1, 0, 5}, 0.01, PointPhase::kMoving);
  edit_.put_on_trial(sim_.id, Why::kMapIsNew);
  EXPECT_EQ(own.phase, PointPhase::kTrial);
  EXPECT_EQ(apart.phase, PointPhase::kStatic);
  EXPECT_EQ(moving.phase, PointPhase::kMoving);
}

TEST_F(PointPenTest, WhatForgotItsPastBeginsWithThisSet) {
  edit_.add_key_frame(SetId(2));
  const MapPoint& p = sim_.add_point(shared_);
  edit_.note_ray(p, kCam0, Eigen::Vector3d::UnitZ());
  ASSERT_FALSE(p.key_observations.empty());
  edit_.forget_past(p);
  EXPECT_TRUE(p.key_observations.empty());
  EXPECT_TRUE(p.updated_from.empty());
  edit_.add_key_frame(SetId(3));
  EXPECT_TRUE(p.key_observations.empty()) << "its tracks are not trusted before this set";
  edit_.add_key_frame(sim_.set.id);
  EXPECT_EQ(p.key_observations.size(), 2U);
}

TEST_F(PointPenTest, AMovedPointIsWhereItWasPutAndNotSeenForThat) {
  const MapPoint& p = sim_.create({0, 0, 5});
  sim_.advance(2);
  edit_.move_point(p, {1, 1, 6}, 2 * Eigen::Matrix3d::Identity());
  EXPECT_EQ(p.position, Eigen::Vector3d(1, 1, 6));
  EXPECT_EQ(p.covariance, 2 * Eigen::Matrix3d::Identity());
  EXPECT_LT(p.last_seen, sim_.set.id);
  EXPECT_EQ(p.views, 0U);
}

TEST_F(PointPenTest, OnlyTheOneObservationIsDropped) {
  edit_.add_key_frame(SetId(2));
  const MapPoint& p = sim_.add_point(shared_);
  ASSERT_EQ(p.key_observations.size(), 2U);
  edit_.drop_observation(p, SetId(2), kCam0, track(kCam1).id);
  edit_.drop_observation(p, SetId(3), kCam0, track(kCam0).id);
  const bool other_number = track(kCam0).id != track(kCam1).id;
  EXPECT_EQ(p.key_observations.size(), other_number ? 2U : 1U);
  edit_.drop_observation(p, SetId(2), kCam0, track(kCam0).id);
  ASSERT_EQ(p.key_observations.size(), 1U);
  EXPECT_EQ(p.key_observations[0].camera, kCam1);
}

}  // namespace
}  // namespace coslam::point_pen_test
