// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/map/edit.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/map_checks.h"
#include "tests/support/matchers.h"
#include "tests/support/sim_map.h"

// What every verb does and notes. Phases and motions are in states_test.cpp.
namespace coslam::edit_test {
namespace {

using test::observed;
using test::PoseNear;

constexpr CameraId kCam0(0), kCam1(1);

class EditTest : public testing::Test {
 protected:
  EditTest() : sim_(world_, test::paths_side_by_side(2)) {
    sim_.advance(5, true);
    while (!sim_.all_follow(shared_)) ++shared_;
    test::forget(edit_.journal());
  }
  const MapCamera& camera(CameraId id) const { return sim_.map.camera(id); }
  const ServerTrack& track(CameraId id) const { return *sim_.track_of(id, shared_); }
  // The one event that was noted since the last call, but for tracks without a point that ended.
  Event only_event() {
    std::vector<Event> events = edit_.journal().events();
    std::erase_if(events, [](const Event& e) { return e.kind == EventKind::kTrackEnded && e.point == PointId(); });
    test::forget(edit_.journal());
    EXPECT_EQ(events.size(), 1U);
    return events.empty() ? Event{} : events.front();
  }
  std::vector<Event> events(EventKind kind) {
    std::vector<Event> out = edit_.journal().events();
    std::erase_if(out, [&](const Event& e) { return e.kind != kind; });
    return out;
  }

  const test::SimWorld world_{{}};
  test::SimMap sim_;
  MapEdit& edit_ = sim_.edit;
  int shared_ = 0;  // a world point that both cameras see
};

TEST_F(EditTest, CamerasJoinOnceAndAgain) {
  const CameraId id = edit_.add_camera("late", RunId(5), test::sim_camera());
  Event e = only_event();
  EXPECT_EQ(e.kind, EventKind::kCameraJoined);
  EXPECT_EQ(e.why, Why::kHello);
  EXPECT_EQ(e.camera, id);
  edit_.set_alive(id, false);
  edit_.restart_camera(id, RunId(6), test::sim_camera());
  e = only_event();
  EXPECT_EQ(e.kind, EventKind::kCameraJoined);
  EXPECT_EQ(e.why, Why::kRestarted);
  EXPECT_TRUE(camera(id).alive);
}

TEST_F(EditTest, ARestartEndsTheTracksAndKnowsWhichWereBound) {
  sim_.add_point(shared_);
  edit_.set_clock_offset(camera(kCam0), 7);
  test::forget(edit_.journal());
  const std::size_t tracks = camera(kCam0).tracks.size();
  edit_.restart_camera(kCam0, RunId(6), test::sim_camera());
  const std::vector<Event> ended = events(EventKind::kTrackEnded);
  EXPECT_EQ(ended.size(), tracks);
  EXPECT_EQ(std::ranges::count_if(ended, [](const Event& e) { return e.point != PointId(); }), 1);
  EXPECT_EQ(camera(kCam0).clock_offset_ns, 0);
  EXPECT_TRUE(camera(kCam0).tracks.empty());
  test::expect_consistent(sim_.map);
}

TEST_F(EditTest, NoiseIsARunningMeanThatIsFasterAtTheBeginning) {
  const CameraId id = edit_.add_camera("late", RunId(5), test::sim_camera());
  edit_.measure_sigma(camera(id), 0.4);
  EXPECT_DOUBLE_EQ(camera(id).sigma_px, 0.4);
  edit_.measure_sigma(camera(id), 0.6);
  EXPECT_DOUBLE_EQ(camera(id).sigma_px, 0.5);
  for (int i = 0; i < 20; ++i) edit_.measure_sigma(camera(id), 0.5);
  edit_.measure_sigma(camera(id), 1.5);
  EXPECT_NEAR(camera(id).sigma_px, 0.6, 1e-9);
}

TEST_F(EditTest, EnteringAMapIsNotedMovingInItIsNot) {
  sim_.ingest();
  test::forget(edit_.journal());
  edit_.place(camera(kCam0), sim_.set.id, sim_.id, test::looking({1, 0, 0}), Why::kPlaceRecognised, {30, 0});
  EXPECT_TRUE(edit_.journal().events().empty());
  EXPECT_THAT(camera(kCam0).frames.back().cam_from_world, PoseNear(test::looking({1, 0, 0}), 1e-12, 1e-12));
  edit_.set_pose(camera(kCam0), sim_.set.id, test::looking({2, 0, 0}));
  edit_.adjust_pose(camera(kCam0), camera(kCam0).frames.front(), test::looking({3, 0, 0}));
  EXPECT_THAT(camera(kCam0).frames.front().cam_from_world, PoseNear(test::looking({3, 0, 0}), 1e-12, 1e-12));
  EXPECT_TRUE(edit_.journal().events().empty());
  const MapId other = edit_.new_map(Why::kStartedAlone, 12);
  Event e = only_event();
  EXPECT_EQ(e.kind, EventKind::kMapStarted);
  EXPECT_EQ(e.map, other);
  EXPECT_EQ(e.figures[0], 12);
  edit_.place(camera(kCam0), sim_.set.id, other, Rigid3(), Why::kPlaceRecognised, {30, 0});
  e = only_event();
  EXPECT_EQ(e.kind, EventKind::kCameraPlaced);
  EXPECT_EQ(e.map, other);
  EXPECT_EQ(e.camera, kCam0);
  EXPECT_EQ(e.figures[0], 30);
}

TEST_F(EditTest, AJointPoseIsForTheAgentUntilTheNextImage) {
  edit_.set_joint_pose(camera(kCam0), test::looking({1, 0, 0}), true);
  EXPECT_TRUE(camera(kCam0).corrected);
  EXPECT_TRUE(camera(kCam0).frames.back().joint);
  edit_.set_joint_pose(camera(kCam1), test::looking({1, 0, 0}), false);
  EXPECT_TRUE(camera(kCam1).corrected);
  EXPECT_FALSE(camera(kCam1).frames.back().joint);
  sim_.ingest();
  EXPECT_FALSE(camera(kCam0).corrected);
  EXPECT_FALSE(camera(kCam0).frames.back().joint);
}

TEST_F(EditTest, LosingThePoseIsNotedOnceUntilItIsBack) {
  for (int i = 1; i <= 3; ++i) {
    sim_.ingest();
    EXPECT_EQ(edit_.lose_pose(camera(kCam0), 40, 5), i);
  }
  const Event e = only_event();
  EXPECT_EQ(e.kind, EventKind::kCameraLost);
  EXPECT_EQ(e.figures, (Figures{40, 5}));
  edit_.set_pose(camera(kCam0), sim_.set.id, sim_.truth(kCam0, sim_.set.id));
  const Event found = only_event();
  EXPECT_EQ(found.kind, EventKind::kCameraFound);
  EXPECT_EQ(found.figures[0], 3) << "sets without a pose";
  EXPECT_EQ(camera(kCam0).lost_sets, 0);
  EXPECT_EQ(edit_.lose_pose(camera(kCam0), 30, 4), 1);
  EXPECT_EQ(only_event().figures, (Figures{30, 4}));
}

TEST_F(EditTest, WhoLeavesAMapTakesItsTracksAlong) {
  const MapPoint& p = sim_.add_point(shared_);
  test::forget(edit_.journal());
  edit_.leave_map(camera(kCam0));
  EXPECT_EQ(p.bound, std::vector<BoundTrack>({{kCam1, track(kCam1).id}}));
  ASSERT_EQ(events(EventKind::kTrackUnbound).size(), 1U);
  EXPECT_EQ(events(EventKind::kTrackUnbound)[0].why, Why::kCameraLeft);
  ASSERT_EQ(events(EventKind::kCameraLeft).size(), 1U);
  EXPECT_EQ(events(EventKind::kCameraLeft)[0].map, sim_.id);
  EXPECT_EQ(camera(kCam0).map, MapId());
  test::expect_consistent(sim_.map);
}

TEST_F(EditTest, WhatTheAgentIsToBeToldAddsUp) {
  const Similarity3 twice{2, Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero()};
  edit_.carry_agent(camera(kCam0), twice);
  edit_.carry_agent(camera(kCam0), twice);
  EXPECT_DOUBLE_EQ(camera(kCam0).moved.scale, 4);
  EXPECT_DOUBLE_EQ(camera(kCam1).moved.scale, 1);
  edit_.mark_announced(camera(kCam0));
  EXPECT_DOUBLE_EQ(camera(kCam0).moved.scale, 1);
}

TEST_F(EditTest, AMergeIsToldByTheFirstMapThatIsGone) {
  const MapId second = edit_.new_map(Why::kStartedAlone, 1), third = edit_.new_map(Why::kStartedAlone, 1);
  sim_.place(kCam0, third, Rigid3());
  test::forget(edit_.journal());
  edit_.merge(third, second, Similarity3());
  const Event e = only_event();
  EXPECT_EQ(e.kind, EventKind::kMapMerged);
  EXPECT_EQ(e.map, second);
  EXPECT_EQ(e.from, third);
  edit_.merge(second, sim_.id, Similarity3());
  EXPECT_EQ(camera(kCam0).map, sim_.id);
  EXPECT_EQ(camera(kCam0).merged_from, third) << "which is what its agent knows";
  EXPECT_EQ(camera(kCam1).merged_from, MapId());
  edit_.mark_announced(camera(kCam0));
  EXPECT_EQ(camera(kCam0).merged_from, MapId());
}

TEST_F(EditTest, MovingAMapIsNotedWithItsScale) {
  edit_.transform(sim_.id, {1.5, Eigen::Quaterniond::Identity(), {1, 0, 0}}, Why::kScaleKnown);
  Event e = only_event();
  EXPECT_EQ(e.kind, EventKind::kMapMoved);
  EXPECT_EQ(e.why, Why::kScaleKnown);
  EXPECT_EQ(e.map, sim_.id);
  EXPECT_DOUBLE_EQ(e.figures[0], 1.5);
  edit_.note_moved(sim_.id, Why::kAdjusted, {24, 300});
  e = only_event();
  EXPECT_EQ(e.why, Why::kAdjusted);
  EXPECT_EQ(e.figures, (Figures{24, 300}));
}

TEST_F(EditTest, BindingIsNotedOnBothEnds) {
  const MapPoint& p = sim_.create(world_.position(shared_));
  test::forget(edit_.journal());
  edit_.miss_gate(kCam0, track(kCam0), 3);
  test::forget(edit_.journal());
  edit_.bind(p, kCam0, track(kCam0), Why::kRegistered, {1.5, 0.8});
  Event e = only_event();
  EXPECT_EQ(e.kind, EventKind::kTrackBound);
  EXPECT_EQ(e.point, p.id);
  EXPECT_EQ(e.track, track(kCam0).id);
  EXPECT_EQ(e.figures, (Figures{1.5, 0.8}));
  EXPECT_EQ(track(kCam0).gate_failures, 0);
  edit_.unbind(kCam0, track(kCam0), Why::kOutsideGate, {3, 5});
  e = only_event();
  EXPECT_EQ(e.kind, EventKind::kTrackUnbound);
  EXPECT_EQ(e.point, p.id) << "the one that it was bound to";
  EXPECT_EQ(e.why, Why::kOutsideGate);
  EXPECT_TRUE(p.bound.empty());
}

TEST_F(EditTest, ATrackOfWhatMovesBringsNoPast) {
  edit_.add_key_frame(SetId(1));
  const MapPoint& p = sim_.create(world_.position(shared_), 0.01, PointPhase::kMoving);
  edit_.bind_moving(p, kCam0, track(kCam0), {1, -2}, Why::kMadeFromIt);
  EXPECT_TRUE(p.key_observations.empty());
  EXPECT_EQ(track(kCam0).offset_px, Eigen::Vector2f(1, -2));
  edit_.unbind(kCam0, track(kCam0), Why::kStray);
  EXPECT_EQ(track(kCam0).offset_px, Eigen::Vector2f::Zero());
}

TEST_F(EditTest, OnlyTheFirstMissOfASuccessionIsNoted) {
  sim_.add_point(shared_);
  test::forget(edit_.journal());
  for (int i = 1; i <= 3; ++i) EXPECT_EQ(edit_.miss_gate(kCam0, track(kCam0), 2.0 + i), i);
  const Event e = only_event();
  EXPECT_EQ(e.kind, EventKind::kTrackMissed);
  EXPECT_EQ(e.figures, (Figures{1, 3}));
  edit_.pass_gate(track(kCam0));
  EXPECT_EQ(track(kCam0).gate_failures, 0);
  EXPECT_EQ(edit_.miss_gate(kCam0, track(kCam0), 9), 1);
  EXPECT_EQ(only_event().figures, (Figures{1, 9}));
}

TEST_F(EditTest, AnEndedTrackIsNotedWithThePointThatItHad) {
  sim_.add_point(shared_);
  test::forget(edit_.journal());
  sim_.look();
  const TrackId ended = track(kCam0).id;
  const PointId point = track(kCam0).point;
  std::erase_if(sim_.set.frames[0].frame.tracks, [&](const TrackObservation& o) { return o.track == ended; });
  sim_.set.frames[0].frame.tracks.pop_back();  // nobody's
  sim_.take();
  const Event e = only_event();
  EXPECT_EQ(e.kind, EventKind::kTrackEnded);
  EXPECT_EQ(e.why, Why::kImageEnded);
  EXPECT_EQ(e.track, ended);
  EXPECT_EQ(e.point, point);
}

TEST_F(EditTest, MappingMayWait) {
  edit_.map_not_before(track(kCam0), SetId(40));
  EXPECT_EQ(track(kCam0).mapping_after, 40U);
}

TEST_F(EditTest, RemovingIsNotedAfterItsTracksAreFree) {
  const MapPoint& p = sim_.add_point(shared_);
  const PointId id = p.id;
  test::forget(edit_.journal());
  edit_.remove_point(p, Why::kUndetermined, {2, 5});
  const std::vector<Event> all = edit_.journal().events();
  ASSERT_EQ(all.size(), 3U);
  EXPECT_EQ(all[0].kind, EventKind::kTrackUnbound);
  EXPECT_EQ(all[1].why, Why::kPointGone);
  EXPECT_EQ(all[2].kind, EventKind::kPointRemoved);
  EXPECT_EQ(all[2].point, id);
  EXPECT_EQ(all[2].why, Why::kUndetermined);
  EXPECT_EQ(all[2].figures, (Figures{2, 5}));
}

TEST_F(EditTest, AnotherPlaceWithoutACovarianceTakesThatOfItsViews) {
  edit_.add_key_frame(SetId(0));
  const MapPoint& p = sim_.add_point(shared_, 1.0);
  const Eigen::Vector3d there = p.position + Eigen::Vector3d(0, 0, 0.1);
  edit_.reposition_point(p, there);
  EXPECT_EQ(p.position, there);
  EXPECT_EQ(p.covariance, sim_.map.covariance_of(p));
  EXPECT_LT(p.covariance.trace(), 3);
  EXPECT_TRUE(edit_.journal().events().back().kind != EventKind::kPointBecame) << "a new estimate is no event";
}

TEST_F(EditTest, SeeingAndFollowingCountAndDate) {
  const MapPoint& p = sim_.create({0, 0, 5});
  const TimeNs first_ns = sim_.set.t_ns;
  sim_.advance(3);
  edit_.see(p);
  EXPECT_EQ(p.views, 1U);
  EXPECT_EQ(p.first_ns, first_ns);
  EXPECT_EQ(p.last_ns, sim_.set.t_ns);
  EXPECT_EQ(p.last_seen, sim_.set.id);
  sim_.advance(1);
  edit_.keep_recent(p);
  EXPECT_EQ(p.views, 1U);
  EXPECT_EQ(p.last_seen, sim_.set.id);
  EXPECT_NE(p.last_ns, sim_.set.t_ns) << "it was not seen";
  edit_.follow(p, {1, 0, 5}, 4 * Eigen::Matrix3d::Identity());
  EXPECT_EQ(p.views, 2U);
  EXPECT_EQ(p.position, Eigen::Vector3d(1, 0, 5));
  EXPECT_EQ(p.covariance, 4 * Eigen::Matrix3d::Identity());
}

TEST_F(EditTest, RaysAreKeptByCamera) {
  const MapPoint& p = sim_.create({0, 0, 5});
  edit_.note_ray(p, kCam1, Eigen::Vector3d::UnitX());
  ASSERT_EQ(p.updated_from.size(), 2U);
  EXPECT_EQ(p.updated_from[0], Eigen::Vector3d::Zero());
  EXPECT_EQ(p.updated_from[1], Eigen::Vector3d::UnitX());
}

TEST_F(EditTest, FusingPutsTheTwoPathsInOrder) {
  const PointId a = sim_.create({0, 0, 5}, 0.01, PointPhase::kMoving).id,
                b = sim_.create({0, 0, 5}, 0.01, PointPhase::kMoving).id;
  for (const std::uint32_t set : {1U, 4U}) edit_.record_motion(a, {SetId(set), 0, {}});
  for (const std::uint32_t set : {0U, 2U, 4U}) edit_.record_motion(b, {SetId(set), 0, {}});
  test::forget(edit_.journal());
  edit_.fuse(a, b, Why::kOneMover);
  const Event e = only_event();
  EXPECT_EQ(e.kind, EventKind::kPointFused);
  EXPECT_EQ(e.point, a);
  EXPECT_EQ(e.other, b);
  std::vector<std::uint32_t> sets;
  for (const MotionSample& s : sim_.map.motions().at(a)) sets.push_back(s.set.value);
  EXPECT_EQ(sets, (std::vector<std::uint32_t>{0, 1, 2, 4, 4}));
  EXPECT_FALSE(sim_.map.motions().contains(b));
  edit_.fuse(a, b, Why::kOneMover);
  edit_.fuse(b, a, Why::kOneMover);
  EXPECT_TRUE(edit_.journal().events().empty()) << "there is no such point any more";
}

TEST_F(EditTest, PatchesAreGivenAndThinned) {
  const MapPoint& p = sim_.add_point(shared_);
  ASSERT_EQ(p.patches.size(), 2U);
  for (int i = 0; i < 6; ++i) edit_.give_patch(p, kCam0, track(kCam0));
  edit_.keep_newest_patches(p, 5);
  ASSERT_EQ(p.patches.size(), 5U);
  sim_.advance(1, true);
  edit_.give_patch(p, kCam1, track(kCam1));
  edit_.thin_patches(3);
  ASSERT_EQ(p.patches.size(), 3U);
  EXPECT_EQ(p.patches.back().set, sim_.set.id);
  const ServerTrack unseen{};
  sim_.advance(1);
  edit_.give_patch(p, kCam1, unseen);
  EXPECT_EQ(p.patches.size(), 3U) << "it has none";
}

TEST_F(EditTest, AKeyImageIsOneCamerasAlone) {
  const MapPoint& p = sim_.add_point(shared_);
  edit_.add_key_image(sim_.set.id, kCam0);
  EXPECT_TRUE(observed(p, sim_.set.id, kCam0, track(kCam0).id));
  EXPECT_FALSE(observed(p, sim_.set.id, kCam1, track(kCam1).id));
  EXPECT_FALSE(sim_.map.is_key_frame(sim_.set.id));
  edit_.add_key_image(sim_.set.id, kCam0);
  EXPECT_EQ(p.key_observations.size(), 1U);
  // Who is bound later brings its observation of it.
  edit_.unbind(kCam0, track(kCam0), Why::kOutsideGate);
  const MapPoint& q = sim_.create(p.position);
  sim_.bind(q, kCam0, track(kCam0));
  EXPECT_TRUE(observed(q, sim_.set.id, kCam0, track(kCam0).id));
}

TEST_F(EditTest, AnObservationIsDropped) {
  edit_.add_key_frame(SetId(1));
  edit_.add_key_frame(SetId(3));
  const MapPoint& p = sim_.add_point(shared_);
  ASSERT_EQ(p.key_observations.size(), 4U);
  edit_.drop_observation(p, SetId(1), kCam0, track(kCam0).id);
  EXPECT_EQ(p.key_observations.size(), 3U);
  EXPECT_FALSE(observed(p, SetId(1), kCam0, track(kCam0).id));
}

// A key is a virtual base: its parts must not be assigned twice, the second time from what was moved away.
TEST(MapEditValue, IsAssignedWhole) {
  MapEdit edit({});
  edit.add_camera("a", RunId(1), test::sim_camera());
  const MapId map = edit.new_map(Why::kStartedTogether, 0);
  edit.create_point(map, Eigen::Vector3d(1, 2, 3), Eigen::Matrix3d::Identity(), PointPhase::kTrial, Why::kStartOfMap);
  MapEdit copied({});
  copied = edit;
  EXPECT_EQ(copied.map().points().size(), 1U);
  MapEdit moved({});
  moved = std::move(edit);
  EXPECT_EQ(moved.map().points().size(), 1U);
  EXPECT_EQ(moved.map().cameras().size(), 1U);
  const MapEdit made(std::move(moved));
  EXPECT_EQ(made.map().points().size(), 1U);
}

}  // namespace
}  // namespace coslam::edit_test
