// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/associate/register.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/matchers.h"
#include "tests/support/sim_map.h"

namespace coslam::register_test {
namespace {

using test::VectorNear;

constexpr CameraId kCam0(0), kCam1(1);

// Two cameras; the points are mapped by the first alone, and the second has tracks on many of them.
class RegisterTest : public testing::Test {
 protected:
  RegisterTest() : sim_(world_, test::paths_side_by_side(2)) {
    sim_.advance(6, true);
    for (int point = 0; point < world_.size(); ++point) {
      const ServerTrack* t = sim_.track_of(kCam0, point);
      if (t != nullptr) sim_.bind(sim_.create(world_.position(point)), kCam0, *t);
    }
    for (shared_ = 0; sim_.track_of(kCam0, shared_) == nullptr || sim_.track_of(kCam1, shared_) == nullptr;) ++shared_;
  }
  RegisterReport step(bool patches = true) {
    sim_.advance(1, patches);
    return register_tracks(sim_.edit, sim_.set);
  }
  const ServerTrack& track() { return *sim_.track_of(kCam1, shared_); }
  const MapPoint& point() { return *sim_.map.find(sim_.track_of(kCam0, shared_)->point); }
  int wrongly_bound() {
    int wrong = 0;
    for (const auto& [id, p] : sim_.map.points()) {
      for (const BoundTrack& b : p.bound) wrong += sim_.world_point(b.camera, b.track) != sim_.world_point(p);
    }
    return wrong;
  }

  const test::SimWorld world_{{}};
  test::SimMap sim_;
  int shared_ = 0;  // a world point that both cameras see
};

TEST_F(RegisterTest, BindsTheSecondCamerasTracksToTheRightPoints) {
  int shared = 0;
  for (const auto& [id, p] : sim_.map.points()) shared += sim_.track_of(kCam1, sim_.world_point(p)) != nullptr;
  const RegisterReport report = step();
  EXPECT_GT(shared, 50);
  EXPECT_GE(report.registered, 0.9 * shared);
  EXPECT_GE(report.candidates, report.registered);
  EXPECT_EQ(wrongly_bound(), 0);
}

TEST_F(RegisterTest, APointThatIsFoundAgainGetsItsNewTrack) {
  test::TrackingConfig tracking{.ends = 0.05, .rebirth_frames = 2};
  test::SimMap sim(world_, test::paths_side_by_side(1), tracking);
  sim.advance(5, true);
  sim.add_points(0.005);
  int registered = 0;
  for (int i = 0; i < 40; ++i) {
    sim.advance(1, true);
    registered += register_tracks(sim.edit, sim.set).registered;
  }
  EXPECT_GT(registered, 100);
  for (const auto& [id, p] : sim.map.points()) {
    EXPECT_LE(p.bound.size(), 1U);
    for (const KeyObservation& o : p.key_observations)
      EXPECT_EQ(sim.world_point(o.camera, o.track), sim.world_point(p));
    if (p.bound.empty()) continue;
    EXPECT_THAT(p.position, VectorNear(world_.position(sim.world_point(p)), 0.1));
  }
}

TEST_F(RegisterTest, AWrongPatchIsRefused) {
  sim_.look(true);
  sim_.patch_of(kCam1, shared_)->grey = world_.patch(shared_ + 1);
  sim_.take();
  sim_.place_truly();
  register_tracks(sim_.edit, sim_.set);
  EXPECT_EQ(track().point, PointId());
  EXPECT_EQ(point().bound.size(), 1U);
  EXPECT_NE(step().registered, 0);
  EXPECT_EQ(track().point, point().id) << "with the right patch it is taken";
}

TEST_F(RegisterTest, WithoutAPatchATrackWaits) {
  test::SimMap sim(world_, test::paths_side_by_side(2));
  for (int i = 0; i < 6; ++i) {
    sim.look(true);
    sim.set.frames[1].patches.reset();
    sim.take();
    sim.place_truly();
  }
  ASSERT_NE(sim.track_of(kCam0, shared_), nullptr);
  sim.bind(sim.create(world_.position(shared_)), kCam0, *sim.track_of(kCam0, shared_));
  sim.advance(1, false);
  EXPECT_EQ(register_tracks(sim.edit, sim.set).registered, 0);
  sim.advance(1, true);
  EXPECT_EQ(register_tracks(sim.edit, sim.set).registered, 1);
}

TEST_F(RegisterTest, TheGateMustHoldInThePastOfTheTrack) {
  sim_.look(true);
  sim_.seen(kCam1, shared_)->undistorted_px += Eigen::Vector2f(20, 0);
  sim_.take();
  sim_.place_truly();
  sim_.advance(1, true);
  register_tracks(sim_.edit, sim_.set);
  EXPECT_EQ(track().point, PointId());
  sim_.edit.distrust_before(track(), sim_.set.id);  // that past is known to be wrong
  register_tracks(sim_.edit, sim_.set);
  EXPECT_EQ(track().point, point().id);
}

TEST_F(RegisterTest, InactivePointsTakeNoPart) {
  test::SimMap sim(world_, test::paths_side_by_side(1), {}, {.recent_s = 5.0 / 30});
  sim.advance(5, true);
  int seen = 0;
  while (sim.track_of(kCam0, seen) == nullptr) ++seen;
  const MapPoint& p = sim.create(world_.position(seen));
  sim.advance(5, true);
  EXPECT_EQ(register_tracks(sim.edit, sim.set).candidates, 1);
  sim.advance(1, true);
  EXPECT_EQ(register_tracks(sim.edit, sim.set).candidates, 0);
  sim.edit.keep_recent(p);
  EXPECT_EQ(register_tracks(sim.edit, sim.set).candidates, 1);
}

TEST_F(RegisterTest, OnlyStaticPointsAreOffered) {
  for (const auto& [id, p] : sim_.map.points()) sim_.set_moving(p);
  EXPECT_EQ(step().candidates, 0);
}

TEST_F(RegisterTest, TheSecondViewMakesThePointBetter) {
  for (const auto& [id, p] : sim_.map.points()) {
    sim_.edit.move_point(p, p.position + Eigen::Vector3d(0.01, -0.01, 0.06), 2e-3 * Eigen::Matrix3d::Identity());
  }
  ASSERT_GT(step().registered, 30);
  std::vector<double> errors, before, values;
  for (const auto& [id, p] : sim_.map.points()) {
    if (p.bound.size() < 2) continue;
    const Eigen::Vector3d error = p.position - world_.position(sim_.world_point(p));
    errors.push_back(error.norm());
    values.push_back(test::nees(error, p.covariance));
  }
  EXPECT_LT(test::median(errors), 0.045) << "it was sqrt(0.01^2 + 0.01^2 + 0.06^2)";
  EXPECT_LT(test::median(values), 5);
}

TEST_F(RegisterTest, RetriangulateLeavesWhatIsNotDetermined) {
  const MapPoint& p = point();  // seen by one camera, which hardly moved
  const Eigen::Vector3d before = p.position;
  ASSERT_EQ(p.bound.size(), 1U);
  EXPECT_FALSE(retriangulate(sim_.edit, p));
  EXPECT_EQ(p.position, before);
}

TEST_F(RegisterTest, RetriangulateUsesBothCameras) {
  sim_.bind(point(), kCam1, track());
  const MapPoint& p = point();
  sim_.shift(p, {0.2, 0.2, -0.3});
  ASSERT_TRUE(retriangulate(sim_.edit, p));
  const Eigen::Vector3d error = p.position - world_.position(shared_);
  EXPECT_LT(error.norm(), 0.15);
  EXPECT_LT(test::nees(error, p.covariance), 12);
}

}  // namespace
}  // namespace coslam::register_test
