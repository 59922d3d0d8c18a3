// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/pose/localise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "tests/support/matchers.h"
#include "tests/support/sim_map.h"

namespace coslam::localise_test {
namespace {

using test::PoseNear;

constexpr CameraId kCam0(0), kCam1(1);

class LocaliseTest : public testing::Test {
 protected:
  explicit LocaliseTest(const test::TrackingConfig& tracking = {})
      : sim_(world_, test::paths_side_by_side(2), tracking) {
    sim_.advance(2);
    sim_.add_points(0.01);
  }
  const MapCamera& camera(CameraId id) { return sim_.map.camera(id); }
  const FramePose& pose(CameraId id) { return camera(id).frames.back(); }
  LocaliseReport step() {
    sim_.ingest();
    const LocaliseReport report = localise(sim_.edit, sim_.set, config_);
    sim_.add_points(0.01);
    return report;
  }
  // Every point of a camera at the place of another.
  void shuffle_points() {
    const MapPoint* last = nullptr;
    for (const auto& [id, p] : sim_.map.points()) {
      if (last != nullptr) {
        const Eigen::Vector3d between = p.position - last->position;
        sim_.shift(*last, between);
        sim_.shift(p, -between);
      }
      last = &p;
    }
  }

  const LocaliseConfig config_;
  const test::SimWorld world_{{.points = 600}};
  test::SimMap sim_;
};

TEST_F(LocaliseTest, FollowsTruth) {
  for (int i = 0; i < 60; ++i) {
    const LocaliseReport report = step();
    ASSERT_EQ(report.tracked, 2);
    ASSERT_EQ(report.lost, 0);
    for (const CameraId c : {kCam0, kCam1}) {
      ASSERT_EQ(pose(c).map, sim_.id);
      ASSERT_THAT(pose(c).cam_from_world, PoseNear(sim_.truth(c, sim_.set.id), 0.003, 0.015));
    }
  }
  EXPECT_LT(camera(kCam0).sigma_px, 0.6) << "noise of 0.3 px, floor of 0.4";
  EXPECT_GT(camera(kCam0).sigma_px, 0.3);
}

TEST_F(LocaliseTest, UsesPointsOnTrialAtOnceWhereFewAreProven) {
  const MapCamera& c = camera(kCam0);
  sim_.edit.put_on_trial(sim_.id, Why::kMapIsNew);
  // Those nearest to a corner of the image are proven: they alone hardly tell a turn from a step.
  std::vector<std::pair<float, const MapPoint*>> from_corner;
  for (const auto& [id, track] : c.tracks) {
    const MapPoint* p = sim_.map.find(track.point);
    if (p != nullptr) from_corner.emplace_back(track.seen.back().undistorted_px.norm(), p);
  }
  std::ranges::sort(from_corner, {}, &std::pair<float, const MapPoint*>::first);
  ASSERT_GT(from_corner.size(), 60U);
  for (int i = 0; i < 14; ++i) sim_.edit.prove(*from_corner[static_cast<std::size_t>(i)].second);
  ASSERT_FALSE(c.sparse) << "it saw enough of them in the set before";
  ASSERT_EQ(step().tracked, 2);
  EXPECT_THAT(pose(kCam0).cam_from_world, PoseNear(sim_.truth(kCam0, sim_.set.id), 0.003, 0.015));
}

class LocaliseWithOutliers : public LocaliseTest {
 protected:
  LocaliseWithOutliers() : LocaliseTest({.outliers = 0.3}) {}
};

TEST_F(LocaliseWithOutliers, FollowsTruth) {
  for (int i = 0; i < 60; ++i) {
    ASSERT_EQ(step().tracked, 2);
    ASSERT_THAT(pose(kCam0).cam_from_world, PoseNear(sim_.truth(kCam0, sim_.set.id), 0.005, 0.025));
  }
}

TEST_F(LocaliseTest, LeavesCamerasWithoutAMapAlone) {
  sim_.edit.leave_map(camera(kCam1));
  const LocaliseReport report = step();
  EXPECT_EQ(report.tracked, 1);
  EXPECT_EQ(report.lost, 0);
  EXPECT_FALSE(pose(kCam1).valid());
}

TEST_F(LocaliseTest, StartsAtTheAgentsPoseWhenItIsOfThisEpoch) {
  // The server's last pose is far off; what the agent says is right, but for the newest map only.
  for (const FramePose& f : camera(kCam0).frames) {
    sim_.edit.adjust_pose(camera(kCam0), f, test::looking({3, 1, 3}, 2.5));
  }
  FrameSet set = sim_.ingest();
  set.frames[0].frame.pose_state = PoseState::kTracked;
  set.frames[0].frame.cam_from_world = sim_.truth(kCam0, set.id);
  set.frames[0].frame.epoch = MapEpoch(sim_.map.epoch().value + 1);
  EXPECT_EQ(localise(sim_.edit, set, config_).lost, 1) << "another epoch";
  set.frames[0].frame.epoch = sim_.map.epoch();
  EXPECT_EQ(localise(sim_.edit, set, config_).tracked, 2);
  EXPECT_THAT(pose(kCam0).cam_from_world, PoseNear(sim_.truth(kCam0, set.id), 0.003, 0.015));
}

TEST_F(LocaliseTest, AnAgentsPoseOfAnOldEpochIsNotUsed) {
  sim_.edit.raise_epoch();
  FrameSet set = sim_.ingest();
  set.frames[0].frame.pose_state = PoseState::kTracked;
  set.frames[0].frame.cam_from_world = test::looking({3, 1, 3}, 2.5);
  set.frames[0].frame.epoch = MapEpoch(0);
  EXPECT_EQ(localise(sim_.edit, set, config_).tracked, 2);
  EXPECT_THAT(pose(kCam0).cam_from_world, PoseNear(sim_.truth(kCam0, set.id), 0.003, 0.015));
}

// After a restart of the server the agent has points that the map lacks.
TEST_F(LocaliseTest, WhereItsPointsDoNotHoldACameraItsAgentsWordDoes) {
  while (sim_.map.points().size() > 8) sim_.edit.remove_point(sim_.map.points().begin()->second, Why::kUndetermined);
  FrameSet set = sim_.ingest();
  TrackFrame& said = set.frames[0].frame;
  said.pose_state = PoseState::kTracked;
  said.cam_from_world = sim_.truth(kCam0, set.id);
  sim_.edit.mark_announced(camera(kCam0));
  said.epoch = sim_.map.epoch();
  said.pose_inliers = 80;
  said.on_own_points = true;
  said.hull_fraction = 0.5;
  const auto lost = [&](auto&& change) {
    FrameSet other = set;
    change(other.frames[0].frame);
    return localise(sim_.edit, other, config_).lost;
  };
  EXPECT_EQ(lost([](TrackFrame& f) { f.epoch.value += 1; }), 2);
  EXPECT_EQ(lost([](TrackFrame& f) { f.pose_inliers = 15; }), 2) << "it hardly knows itself";
  EXPECT_EQ(lost([](TrackFrame& f) { f.hull_fraction = 0.05F; }), 2);
  EXPECT_EQ(lost([](TrackFrame& f) { f.pose_state = PoseState::kLost; }), 2);
  EXPECT_EQ(lost([](TrackFrame& f) { f.on_own_points = false; }), 2) << "what it rests on is here, and does not fit";
  const LocaliseReport report = localise(sim_.edit, set, config_);
  EXPECT_EQ(report.on_own_word, 1);
  EXPECT_EQ(report.lost, 1);
  EXPECT_THAT(pose(kCam0).cam_from_world, PoseNear(sim_.truth(kCam0, set.id), 1e-9, 1e-9));
  EXPECT_TRUE(pose(kCam0).joint) << "nothing is solved for it on what the map has";
  EXPECT_EQ(camera(kCam0).lost_sets, 0);
}

TEST_F(LocaliseTest, NoPoseRatherThanAWrongOne) {
  shuffle_points();
  EXPECT_EQ(step().lost, 2);
  EXPECT_FALSE(pose(kCam0).valid());
  EXPECT_EQ(camera(kCam0).lost_sets, 1);
  EXPECT_EQ(camera(kCam0).map, sim_.id) << "it does not leave at once";
}

TEST_F(LocaliseTest, FewPointsGiveNoPose) {
  while (sim_.map.points().size() > 8) sim_.edit.remove_point(sim_.map.points().begin()->second, Why::kUndetermined);
  sim_.ingest();
  EXPECT_EQ(localise(sim_.edit, sim_.set, config_).lost, 2);
}

TEST_F(LocaliseTest, LeavesItsMapAfterSoManySets) {
  shuffle_points();
  for (int i = 0; i < camera(kCam0).frames_in(config_.lost_after_s); ++i) {
    sim_.ingest();
    localise(sim_.edit, sim_.set, config_);
    ASSERT_EQ(camera(kCam0).map, sim_.id) << i;
  }
  sim_.ingest();
  localise(sim_.edit, sim_.set, config_);
  EXPECT_EQ(camera(kCam0).map, MapId());
  for (const auto& [id, t] : camera(kCam0).tracks) EXPECT_EQ(t.point, PointId());
  for (const auto& [id, p] : sim_.map.points()) EXPECT_TRUE(p.bound.empty());
}

TEST_F(LocaliseTest, ComesBackWhenThePointsFitAgain) {
  shuffle_points();
  for (int i = 0; i < 5; ++i) {
    sim_.ingest();
    localise(sim_.edit, sim_.set, config_);
  }
  for (const auto& [id, p] : sim_.map.points()) {
    if (!p.bound.empty()) sim_.shift(p, world_.position(sim_.world_point(p)) - p.position);
  }
  EXPECT_EQ(step().tracked, 2);
  EXPECT_EQ(camera(kCam0).lost_sets, 0);
  EXPECT_THAT(pose(kCam0).cam_from_world, PoseNear(sim_.truth(kCam0, sim_.set.id), 0.003, 0.015));
}

TEST_F(LocaliseTest, StandsOnStaticPointsOnly) {
  int i = 0;
  for (const auto& [id, p] : sim_.map.points()) {
    if (++i % 2 == 0) continue;
    sim_.set_moving(p);
    sim_.shift(p, {0.5, 0, 0});  // they all walk the same way
  }
  EXPECT_EQ(step().tracked, 2);
  EXPECT_THAT(pose(kCam0).cam_from_world, PoseNear(sim_.truth(kCam0, sim_.set.id), 0.004, 0.02));
}

TEST_F(LocaliseTest, APastPoseFromTheTracksThatLive) {
  for (int i = 0; i < 5; ++i) sim_.ingest();
  const SetId past(4);
  EXPECT_FALSE(localise_past(sim_.edit, camera(kCam0), SetId(77), sim_.truth(kCam0, past), config_)) << "no such set";
  ASSERT_TRUE(localise_past(sim_.edit, camera(kCam0), past, sim_.truth(kCam0, sim_.set.id), config_));
  const FramePose& f = *camera(kCam0).frame_at(past);
  EXPECT_EQ(f.map, sim_.id);
  EXPECT_THAT(f.cam_from_world, PoseNear(sim_.truth(kCam0, past), 0.003, 0.015));
  EXPECT_FALSE(camera(kCam0).frame_at(SetId(3))->valid());
}

}  // namespace
}  // namespace coslam::localise_test
