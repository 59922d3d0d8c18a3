// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/pose/pose_tracker.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/matchers.h"
#include "tests/support/sim_tracker.h"
#include "tests/support/sim_world.h"

namespace coslam::pose_tracker_test {
namespace {

using test::PoseNear;

constexpr RunId kAgentRun(5), kServerRun(9);
constexpr TimeNs kPeriodNs = 33'333'333;

// A pose tracker whose local map is the true one, at the tracks that it is given.
class PoseTrackerTest : public testing::Test {
 protected:
  PoseTrackerTest() : map_(kAgentRun), pose_(test::sim_camera(), {}) {}

  // Binds every live track of a static point; the server would do so by patches.
  void bind_all(const TrackFrame& frame, const Eigen::Vector3d& off_m = Eigen::Vector3d::Zero()) {
    MapPatch patch = next_patch();
    for (const TrackObservation& o : frame.tracks) {
      const int point = tracker_.point_of(o.track);
      BoundPoint b{o.track, PointId(static_cast<std::uint32_t>(point + 1))};
      b.position = (world_.position(point) + off_m).cast<float>();
      b.covariance = pack_covariance(1e-4 * Eigen::Matrix3d::Identity());
      patch.updated.push_back(b);
    }
    ASSERT_TRUE(map_.apply(patch).accepted);
  }
  MapPatch next_patch() {
    MapPatch patch;
    patch.server_run = kServerRun;
    patch.agent_run = kAgentRun;
    patch.sequence = ++sequence_;
    patch.snapshot = sequence_ == 1;
    patch.epoch = map_.epoch();
    return patch;
  }
  TrackFrame next_frame() {
    const TrackFrame f = tracker_.observe(FrameId(next_), time_of(next_));
    ++next_;
    return f;
  }
  void step(bool bind = true, bool alone = false) {
    const TrackFrame f = next_frame();
    if (bind) bind_all(f);
    map_.keep_only(f.tracks);
    pose_.step(f.frame, f.capture_ns, f.tracks, map_, alone);
  }
  static TimeNs time_of(std::uint32_t frame) { return kPeriodNs * frame; }
  Rigid3 truth(std::uint32_t frame) const { return tracker_.truth(time_of(frame)); }
  std::uint32_t newest() const { return next_ - 1; }
  void start() {
    step();
    pose_.place({FrameId(newest()), truth(newest())});
    step();
    ASSERT_EQ(pose_.state(), PoseState::kTracked);
  }

  const test::SimWorld world_{{}};
  test::SimTracker tracker_{world_, test::wave_path({}), {}, "cam0", kAgentRun};
  LocalMap map_;
  PoseTracker pose_;
  std::uint32_t next_ = 0, sequence_ = 0;
};

TEST_F(PoseTrackerTest, HasNoPoseBeforeItIsPlaced) {
  step();
  step();
  EXPECT_EQ(pose_.state(), PoseState::kNone);
}

TEST_F(PoseTrackerTest, FollowsTruthOncePlaced) {
  start();
  for (int i = 0; i < 120; ++i) {
    step();
    ASSERT_EQ(pose_.state(), PoseState::kTracked);
    ASSERT_THAT(pose_.result().cam_from_world, PoseNear(truth(newest()), 0.002, 0.01));
  }
  EXPECT_GT(pose_.inlier_hull_fraction(), 0.5);
  EXPECT_GT(pose_.result().inliers, 50);
  EXPECT_GT(pose_.result().covariance.diagonal().minCoeff(), 0);
}

TEST_F(PoseTrackerTest, AnOldPlacedPoseIsEnough) {
  for (int i = 0; i < 5; ++i) step();
  pose_.place({FrameId(2), truth(2)});  // the server answers late
  EXPECT_EQ(pose_.state(), PoseState::kLost) << "placed, not yet tracked";
  step();
  EXPECT_EQ(pose_.state(), PoseState::kTracked);
  EXPECT_THAT(pose_.result().cam_from_world, PoseNear(truth(newest()), 0.002, 0.01));
}

TEST_F(PoseTrackerTest, IsLostWithoutPointsAndComesBackWithThem) {
  start();
  map_.clear();
  sequence_ = 0;
  step(false);
  EXPECT_EQ(pose_.state(), PoseState::kLost);
  EXPECT_EQ(pose_.inlier_hull_fraction(), 0);
  for (int i = 0; i < 5; ++i) step(false);
  EXPECT_EQ(pose_.state(), PoseState::kLost);
  step();
  EXPECT_EQ(pose_.state(), PoseState::kTracked);
  EXPECT_THAT(pose_.result().cam_from_world, PoseNear(truth(newest()), 0.002, 0.01));
}

// The server falls silent: its points go with the tracks that showed them.
TEST_F(PoseTrackerTest, AloneItRestsOnPointsOfItsOwn) {
  start();
  for (int i = 0; i < 60; ++i) step();
  map_.clear();
  sequence_ = 0;
  double worst_m = 0;
  for (int i = 0; i < 900; ++i) {
    step(false, true);
    ASSERT_EQ(pose_.state(), PoseState::kTracked) << "lost after " << i << " frames";
    worst_m = std::max(worst_m, (pose_.result().cam_from_world.center() - truth(newest()).center()).norm());
  }
  EXPECT_LT(worst_m, 0.3) << "it drifts, no more";
  step();
  EXPECT_THAT(pose_.result().cam_from_world, PoseNear(truth(newest()), 0.002, 0.01)) << "the server is back";
}

// The first words of a server that is back tell of few points, if any.
TEST_F(PoseTrackerTest, ItRestsOnPointsOfItsOwnUntilTheServersSuffice) {
  start();
  for (int i = 0; i < 60; ++i) step();
  EXPECT_FALSE(pose_.on_own_points());
  map_.clear();
  sequence_ = 0;
  for (int i = 0; i < 30; ++i) step(false, true);
  for (int i = 0; i < 30; ++i) {
    step(false, false);
    ASSERT_EQ(pose_.state(), PoseState::kTracked) << i;
    EXPECT_TRUE(pose_.on_own_points());
  }
  for (int i = 0; i < 2; ++i) step();
  EXPECT_FALSE(pose_.on_own_points());
  EXPECT_THAT(pose_.result().cam_from_world, PoseNear(truth(newest()), 0.002, 0.01));
}

TEST_F(PoseTrackerTest, ItsOwnPointsMoveWithTheMap) {
  start();
  for (int i = 0; i < 60; ++i) step();
  const Similarity3 move{2.0, so3_exp({0.3, -0.2, 0.5}), {4, -1, 2}};
  pose_.rebase(move);
  map_.clear();
  for (int i = 0; i < 10; ++i) step(false, true);
  ASSERT_EQ(pose_.state(), PoseState::kTracked);
  EXPECT_THAT(pose_.result().cam_from_world, PoseNear(transform_world(truth(newest()), move), 0.004, 0.04));
}

TEST_F(PoseTrackerTest, IsLostWhenTheMapContradictsTheTracks) {
  start();
  const TrackFrame f = next_frame();
  MapPatch patch = next_patch();
  for (std::size_t i = 0; i < f.tracks.size(); ++i) {  // every track on the point of another
    BoundPoint b{f.tracks[i].track, PointId(static_cast<std::uint32_t>(i + 1))};
    const int other = tracker_.point_of(f.tracks[(i * 37 + 11) % f.tracks.size()].track);
    b.position = world_.position(other).cast<float>();
    b.covariance = pack_covariance(1e-6 * Eigen::Matrix3d::Identity());
    patch.updated.push_back(b);
  }
  map_.apply(patch);
  pose_.step(f.frame, f.capture_ns, f.tracks, map_);
  EXPECT_EQ(pose_.state(), PoseState::kLost);
}

TEST_F(PoseTrackerTest, UsesStaticPointsOnly) {
  start();
  const TrackFrame f = next_frame();
  bind_all(f);
  MapPatch patch = next_patch();
  for (std::size_t i = 0; i < f.tracks.size(); i += 2) {  // half of them walked away
    BoundPoint b{f.tracks[i].track, PointId(static_cast<std::uint32_t>(i + 1)), PointState::kDynamic};
    b.position = Eigen::Vector3f(0, 0, 4);
    patch.updated.push_back(b);
  }
  map_.apply(patch);
  pose_.step(f.frame, f.capture_ns, f.tracks, map_);
  EXPECT_EQ(pose_.result().is_inlier.size(), f.tracks.size() / 2);
  EXPECT_THAT(pose_.result().cam_from_world, PoseNear(truth(newest()), 0.002, 0.01));
}

TEST_F(PoseTrackerTest, RebaseMovesPoseAndMotion) {
  start();
  step();
  const Similarity3 new_from_old{2.0, so3_exp({0.1, 0.5, -0.2}), {3, -1, 2}};
  MapPatch patch = next_patch();
  patch.epoch = MapEpoch(1);
  patch.new_from_old = new_from_old;
  const PatchEffect effect = map_.apply(patch);
  ASSERT_TRUE(effect.rebase);
  pose_.rebase(*effect.rebase);
  step(false);  // on the points that the map moved, from the motion that was moved with them
  EXPECT_EQ(pose_.state(), PoseState::kTracked);
  EXPECT_THAT(pose_.result().cam_from_world, PoseNear(transform_world(truth(newest()), new_from_old), 0.003, 0.02));
}

TEST_F(PoseTrackerTest, APlacedPoseOfThePastKeepsTheMotionSince) {
  start();
  const std::uint32_t then = newest();
  for (int i = 0; i < 3; ++i) step();
  // The server corrects the frame `then`: the whole world was a step to the right.
  const Similarity3 shift{1.0, Eigen::Quaterniond::Identity(), {0.5, 0, 0}};
  pose_.place({FrameId(then), transform_world(truth(then), shift)});
  const TrackFrame f = next_frame();
  bind_all(f, shift.translation);
  pose_.step(f.frame, f.capture_ns, f.tracks, map_);
  ASSERT_EQ(pose_.state(), PoseState::kTracked);
  EXPECT_THAT(pose_.result().cam_from_world, PoseNear(transform_world(truth(newest()), shift), 0.002, 0.01));
  EXPECT_LE(pose_.result().iterations, 5) << "it started where it was";
}

TEST_F(PoseTrackerTest, ResetForgetsEverything) {
  start();
  pose_.reset();
  EXPECT_EQ(pose_.state(), PoseState::kNone);
  step();
  EXPECT_EQ(pose_.state(), PoseState::kNone);
}

// Fifteen points in one corner, with noise: without its own motion each pose would be decimetres off.
TEST_F(PoseTrackerTest, WherePointsAreFewItGoesOnAsItWent) {
  start();
  for (int i = 0; i < 60; ++i) step();
  std::vector<double> errors_m;
  for (int i = 0; i < 30; ++i) {
    TrackFrame f = next_frame();
    bind_all(f);
    std::erase_if(f.tracks,
                  [](const TrackObservation& o) { return o.undistorted_px.x() > 320 || o.undistorted_px.y() > 240; });
    if (f.tracks.size() > 15) f.tracks.resize(15);
    map_.keep_only(f.tracks);
    pose_.step(f.frame, f.capture_ns, f.tracks, map_);
    ASSERT_EQ(pose_.state(), PoseState::kTracked) << i << " with " << f.tracks.size();
    errors_m.push_back((pose_.result().cam_from_world.center() - truth(newest()).center()).norm());
  }
  EXPECT_LT(*std::ranges::max_element(errors_m), 0.03);
}

// Told by the server where no points are: how far away things are does not matter while the camera turns.
TEST_F(PoseTrackerTest, DirectionsHoldItWherePointsDoNot) {
  start();
  const std::uint32_t known = newest();
  for (int i = 0; i < 10; ++i) {
    const TrackFrame f = next_frame();
    MapPatch patch = next_patch();
    patch.snapshot = true;
    for (const TrackObservation& o : f.tracks) {
      // On the ray from where the camera was when it was known, at twice the true distance.
      const Eigen::Vector3d eye = truth(known).center();
      BoundPoint b{o.track, PointId(), PointState::kUncertain};
      const Eigen::Vector3d way = 2 * (world_.position(tracker_.point_of(o.track)) - eye);
      b.position = (eye + way).cast<float>();
      b.covariance = pack_covariance(way * way.transpose() + 1e-4 * Eigen::Matrix3d::Identity());
      patch.updated.push_back(b);
    }
    ASSERT_TRUE(map_.apply(patch).accepted);
    pose_.step(f.frame, f.capture_ns, f.tracks, map_);
    ASSERT_EQ(pose_.state(), PoseState::kTracked) << i;
    EXPECT_LT(pose_.result().cam_from_world.rotation.angularDistance(truth(newest()).rotation), 0.004) << i;
  }
}

}  // namespace
}  // namespace coslam::pose_tracker_test
