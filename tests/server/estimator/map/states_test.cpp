// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/map/states.h"

#include <gtest/gtest.h>

#include <vector>

#include "server/estimator/map/edit.h"
#include "tests/support/map_checks.h"
#include "tests/support/sim_map.h"

// The two machines of the map, one transition after the other.
namespace coslam::states_test {
namespace {

using enum PointPhase;

constexpr CameraId kCam0(0), kCam1(1);

TEST(PointPhases, AreThoseOfTheTable) {
  EXPECT_TRUE(may_become(kTrial, kStatic));
  EXPECT_TRUE(may_become(kTrial, kMoving));
  EXPECT_TRUE(may_become(kStatic, kTrial));
  EXPECT_TRUE(may_become(kStatic, kMoving));
  EXPECT_TRUE(may_become(kMoving, kTrial));
  EXPECT_FALSE(may_become(kMoving, kStatic)) << "it has to stand the trial first";
  for (const PointPhase same : {kTrial, kStatic, kMoving}) EXPECT_FALSE(may_become(same, same));
}

// A point that two cameras have seen for five sets.
class States : public testing::Test {
 protected:
  States() : sim_(world_, test::paths_side_by_side(2)) {
    sim_.advance(5);
    while (!sim_.all_follow(shared_)) ++shared_;
  }
  const MapPoint& point_in(PointPhase phase) {
    const MapPoint& p = sim_.add_point(shared_, 0.01, Eigen::Vector3d::Zero(), phase);
    test::forget(sim_.edit.journal());
    return p;
  }
  const ServerTrack& track(CameraId camera) { return *sim_.track_of(camera, shared_); }
  // The one event of a kind since the last call.
  Event the(EventKind kind) {
    std::vector<Event> found;
    for (const Event& e : sim_.edit.journal().events()) {
      if (e.kind == kind) found.push_back(e);
    }
    EXPECT_EQ(found.size(), 1U);
    test::forget(sim_.edit.journal());
    return found.empty() ? Event{} : found.front();
  }
  void expect_became(const MapPoint& p, PointPhase phase, Why why, double figure) {
    EXPECT_EQ(p.phase, phase);
    const Event e = the(EventKind::kPointBecame);
    EXPECT_EQ(e.point, p.id);
    EXPECT_EQ(e.map, sim_.id);
    EXPECT_EQ(e.set, sim_.set.id);
    EXPECT_EQ(e.t_ns, sim_.set.t_ns);
    EXPECT_EQ(e.to, static_cast<std::uint8_t>(phase));
    EXPECT_EQ(e.why, why);
    EXPECT_EQ(e.figures[0], figure);
  }
  void start_moving(const MapPoint& p) {
    sim_.edit.start_moving(p, p.position, p.covariance, Why::kSeenElsewhere, {2, 0});
  }

  const test::SimWorld world_{{}};
  test::SimMap sim_;
  int shared_ = 0;
};

TEST_F(States, APointIsMadeInAnyPhase) {
  for (const PointPhase phase : {kTrial, kStatic, kMoving}) {
    test::forget(sim_.edit.journal());
    const MapPoint& p = sim_.edit.create_point(sim_.id, {0, 0, 5}, Eigen::Matrix3d::Identity(), phase,
                                               Why::kOneCamerasMotion, {30, 0.1});
    EXPECT_EQ(p.phase, phase);
    const Event e = the(EventKind::kPointMade);
    EXPECT_EQ(e.point, p.id);
    EXPECT_EQ(e.to, static_cast<std::uint8_t>(phase));
    EXPECT_EQ(e.why, Why::kOneCamerasMotion);
    EXPECT_EQ(e.figures, (Figures{30, 0.1}));
  }
}

TEST_F(States, TrialToStatic) {
  const MapPoint& p = point_in(kTrial);
  for (int i = 0; i < 20; ++i) sim_.edit.see(p);
  sim_.edit.prove(p);
  expect_became(p, kStatic, Why::kStoodTheTrial, 20);
  sim_.edit.prove(p);
  EXPECT_TRUE(sim_.edit.journal().events().empty()) << "it is proven already";
}

TEST_F(States, TrialToMoving) {
  const MapPoint& p = point_in(kTrial);
  start_moving(p);
  expect_became(p, kMoving, Why::kSeenElsewhere, 2);
}

TEST_F(States, StaticToMovingLeavesItsPastBehind) {
  sim_.edit.add_key_frame(SetId(1));
  const MapPoint& p = point_in(kStatic);
  sim_.edit.miss_gate(kCam0, track(kCam0), 4);
  sim_.edit.note_ray(p, kCam0, Eigen::Vector3d::UnitZ());
  ASSERT_EQ(p.key_observations.size(), 2U);
  const Eigen::Vector3d there = p.position + Eigen::Vector3d::UnitX();
  sim_.edit.start_moving(p, there, 2 * Eigen::Matrix3d::Identity(), Why::kSeenElsewhere, {2, 0});
  expect_became(p, kMoving, Why::kSeenElsewhere, 2);
  EXPECT_EQ(p.position, there);
  EXPECT_EQ(p.covariance, 2 * Eigen::Matrix3d::Identity());
  EXPECT_TRUE(p.key_observations.empty() && p.updated_from.empty());
  for (const CameraId c : {kCam0, kCam1}) {
    EXPECT_TRUE(track(c).moves());
    EXPECT_EQ(track(c).gate_failures, 0);
    EXPECT_EQ(track(c).distrusted_before, sim_.set.id.value);
  }
  EXPECT_EQ(sim_.map.moving_points(), std::vector<const MapPoint*>{&p});
}

TEST_F(States, StaticToTrialWhenItsMapIsNew) {
  const MapPoint& p = point_in(kStatic);
  const MapId other = sim_.edit.new_map(Why::kStartedAlone, 1);
  const MapPoint& elsewhere = sim_.create(other, {0, 0, 5});
  test::forget(sim_.edit.journal());
  sim_.edit.put_on_trial(sim_.id, Why::kMapIsNew);
  expect_became(p, kTrial, Why::kMapIsNew, 0);
  EXPECT_TRUE(elsewhere.proven()) << "another map";
  sim_.edit.put_on_trial(sim_.id, Why::kMapIsNew);
  EXPECT_TRUE(sim_.edit.journal().events().empty()) << "once";
}

TEST_F(States, MovingToTrialTrustsTheLastFramesAlone) {
  const MapPoint& p = point_in(kMoving);
  sim_.edit.see(p);
  sim_.edit.miss_gate(kCam0, track(kCam0), 4);
  test::forget(sim_.edit.journal());
  sim_.edit.stop_moving(p, 2);
  expect_became(p, kTrial, Why::kStopped, 2);
  EXPECT_EQ(p.views, 0U) << "the trial begins";
  for (const CameraId c : {kCam0, kCam1}) {
    EXPECT_EQ(track(c).motion, TrackMotion::kResting);
    EXPECT_EQ(track(c).gate_failures, 0);
    EXPECT_EQ(track(c).distrusted_before, sim_.set.id.value - 1);
  }
  EXPECT_TRUE(sim_.map.moving_points().empty());
  sim_.edit.prove(p);
  expect_became(p, kStatic, Why::kStoodTheTrial, 0);
}

TEST_F(States, WhatStoppedBeforeItsTracksWereSoOldTrustsThemWhole) {
  const MapPoint& p = point_in(kMoving);
  sim_.edit.stop_moving(p, 100);
  EXPECT_EQ(track(kCam0).distrusted_before, track(kCam0).seen.front().set.value);
}

TEST_F(States, FusingProvesWhatIsOnTrialByWhatIsStatic) {
  const MapPoint& kept = point_in(kTrial);
  const MapPoint& proven = sim_.create(kept.position);
  test::forget(sim_.edit.journal());
  sim_.edit.fuse(kept.id, proven.id, Why::kOneCorner, {0.5, 0.9});
  const Event fused = sim_.edit.journal().events().back();
  EXPECT_EQ(fused.kind, EventKind::kPointFused);
  EXPECT_EQ(fused.figures, (Figures{0.5, 0.9}));
  expect_became(kept, kStatic, Why::kOtherWasProven, 0);
}

TEST_F(States, FusingStopsNothingThatMoves) {
  const MapPoint& kept = point_in(kMoving);
  const MapPoint& proven = sim_.create(kept.position);
  sim_.edit.fuse(kept.id, proven.id, Why::kOneMover);
  EXPECT_EQ(kept.phase, kMoving);
}

using StatesDeathTest = States;

TEST_F(StatesDeathTest, WhatMovesIsNotProven) {
  const MapPoint& p = point_in(kMoving);
  EXPECT_DEATH(sim_.edit.prove(p), "follow the table in states.h");
}

// From every motion of a track to every other one.
TEST_F(States, MotionsOfATrackAreNotedOnce) {
  using enum TrackMotion;
  const auto expect_becomes = [&](TrackMotion to, Why why) {
    const TrackMotion from = track(kCam0).motion;
    sim_.edit.set_motion(kCam0, track(kCam0), to);
    EXPECT_EQ(track(kCam0).motion, to);
    const Event e = the(EventKind::kTrackBecame);
    EXPECT_EQ(e.why, why) << name_of(from) << " to " << name_of(to);
    EXPECT_EQ(e.to, static_cast<std::uint8_t>(to));
    EXPECT_EQ(e.camera, kCam0);
    EXPECT_EQ(e.track, track(kCam0).id);
    sim_.edit.set_motion(kCam0, track(kCam0), to);
    EXPECT_TRUE(sim_.edit.journal().events().empty()) << "the same again";
  };
  test::forget(sim_.edit.journal());
  expect_becomes(kDoubtful, Why::kNoStaticPlace);
  expect_becomes(kMoving, Why::kNoStaticPlace);
  expect_becomes(kDoubtful, Why::kStaticPlace);
  expect_becomes(kResting, Why::kStaticPlace);
  expect_becomes(kMoving, Why::kNoStaticPlace);
  expect_becomes(kResting, Why::kStaticPlace);
  EXPECT_EQ(track(kCam1).motion, kResting);
}

TEST_F(States, ATrackBoundToWhatMovesMoves) {
  const MapPoint& p = sim_.create({0, 0, 5}, 0.01, kMoving);
  sim_.edit.bind_moving(p, kCam0, track(kCam0), {1, 2}, Why::kLooksLikeIt, {0.9, 0});
  EXPECT_TRUE(track(kCam0).moves());
  EXPECT_EQ(track(kCam0).offset_px, Eigen::Vector2f(1, 2));
  const Event e = the(EventKind::kTrackBound);
  EXPECT_EQ(e.why, Why::kLooksLikeIt);
  EXPECT_EQ(e.to, static_cast<std::uint8_t>(TrackMotion::kMoving));
}

TEST(ToldStates, AreThoseOfFilesAndAgents) {
  EXPECT_EQ(told_state(kTrial), PointState::kStatic);
  EXPECT_EQ(told_state(kStatic), PointState::kStatic);
  EXPECT_EQ(told_state(kMoving), PointState::kDynamic);
}

}  // namespace
}  // namespace coslam::states_test
