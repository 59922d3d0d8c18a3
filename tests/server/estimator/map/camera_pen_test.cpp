// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/map/camera_pen.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/support/map_checks.h"
#include "tests/support/matchers.h"
#include "tests/support/sim_map.h"

// What agents were told, and poses that come from elsewhere. How poses are lost and found is in edit_test.cpp.
namespace coslam::camera_pen_test {
namespace {

using test::PoseNear;
using test::SimilarityNear;

constexpr CameraId kCam0(0), kCam1(1);

class CameraPenTest : public testing::Test {
 protected:
  CameraPenTest() { sim_.advance(4); }
  const MapCamera& camera() const { return sim_.map.camera(kCam0); }
  std::vector<Event> events(EventKind kind) const {
    std::vector<Event> out = edit_.journal().events();
    std::erase_if(out, [&](const Event& e) { return e.kind != kind; });
    return out;
  }

  const test::SimWorld world_{{.points = 60}};
  test::SimMap sim_{world_, test::paths_side_by_side(2)};
  MapEdit& edit_ = sim_.edit;
  const Similarity3 one_{2, so3_exp({0.1, 0, 0}), {1, 0, 0}}, other_{0.5, so3_exp({0, 0.3, 0}), {0, 2, 0}};
};

TEST_F(CameraPenTest, HowTheWorldMovedIsKnownSinceEachEpochThatWasTold) {
  const MapEpoch first = sim_.map.epoch();
  edit_.mark_announced(camera());
  edit_.set_scene_depth(camera(), 3);
  edit_.carry_agent(camera(), one_);
  edit_.raise_epoch();
  EXPECT_EQ(camera().moved_since(sim_.map.epoch()), std::nullopt) << "the agent was not told of it";
  edit_.mark_announced(camera());
  edit_.carry_agent(camera(), other_);
  const auto since_first = camera().moved_since(first), since_last = camera().moved_since(sim_.map.epoch());
  ASSERT_TRUE(since_first && since_last);
  EXPECT_THAT(*since_first, SimilarityNear(other_ * one_, 1e-7, 1e-9, 1e-12));
  EXPECT_THAT(*since_last, SimilarityNear(other_, 1e-7, 1e-9, 1e-12));
  EXPECT_THAT(camera().moved, SimilarityNear(other_, 1e-7, 1e-9, 1e-12)) << "since the last patch";
  EXPECT_DOUBLE_EQ(camera().scene_depth, 3 * one_.scale * other_.scale);
}

TEST_F(CameraPenTest, TheNewestEpochsAreRemembered) {
  constexpr std::uint32_t kTold = 100, kKept = 64;
  std::vector<MapEpoch> told;
  for (std::uint32_t i = 0; i < kTold; ++i) {
    edit_.raise_epoch();
    told.push_back(sim_.map.epoch());
    edit_.mark_announced(camera());
    edit_.mark_announced(camera());  // one epoch is told in many patches
  }
  EXPECT_EQ(camera().announced.size(), kKept);
  EXPECT_EQ(camera().moved_since(told[kTold - kKept - 1]), std::nullopt);
  EXPECT_TRUE(camera().moved_since(told[kTold - kKept]));
  EXPECT_TRUE(camera().moved_since(told.back()));
}

TEST_F(CameraPenTest, EpochsOfAnotherMapTellNothing) {
  edit_.mark_announced(camera());
  const MapEpoch told = sim_.map.epoch();
  sim_.place_truly(kCam0);
  EXPECT_TRUE(camera().moved_since(told)) << "it stays in its map";
  sim_.place(kCam0, edit_.new_map(Why::kStartedAlone, 1), Rigid3());
  EXPECT_EQ(camera().moved_since(told), std::nullopt);
  edit_.mark_announced(camera());
  edit_.leave_map(camera());
  EXPECT_EQ(camera().moved_since(told), std::nullopt);
}

TEST_F(CameraPenTest, WhoWasLostIsPlacedAgain) {
  sim_.ingest();
  EXPECT_EQ(edit_.lose_pose(camera(), 20, 3), 1);
  test::forget(edit_.journal());
  edit_.place(camera(), sim_.set.id, sim_.id, sim_.truth(kCam0, sim_.set.id), Why::kPlaceRecognised, {30, 0});
  ASSERT_EQ(events(EventKind::kCameraPlaced).size(), 1U);
  EXPECT_EQ(events(EventKind::kCameraPlaced)[0].why, Why::kPlaceRecognised);
  EXPECT_TRUE(events(EventKind::kCameraFound).empty()) << "one change is told once";
  EXPECT_EQ(camera().lost_sets, 0);
}

TEST_F(CameraPenTest, WhoLeavesSaysForHowLongItWasLost) {
  for (int i = 0; i < 5; ++i) {
    sim_.ingest();
    edit_.lose_pose(camera(), 20, 3);
  }
  edit_.leave_map(camera());
  ASSERT_EQ(events(EventKind::kCameraLeft).size(), 1U);
  EXPECT_EQ(events(EventKind::kCameraLeft)[0].figures[0], 5);
  EXPECT_EQ(camera().lost_sets, 0);
}

TEST_F(CameraPenTest, TheAgentsOwnPoseRestsOnMoreThanTheMap) {
  sim_.ingest();
  edit_.accept_agent_pose(camera(), test::looking({1, 0, 0}));
  EXPECT_TRUE(camera().frames.back().joint);
  EXPECT_FALSE(camera().corrected) << "it is the agent's already";
  EXPECT_EQ(camera().frames.back().map, sim_.id);
  EXPECT_THAT(camera().frames.back().cam_from_world, PoseNear(test::looking({1, 0, 0}), 1e-12, 1e-12));
  edit_.push_pose_to_agent(camera());
  EXPECT_TRUE(camera().corrected);
}

TEST_F(CameraPenTest, AnEarlierFrameWithoutAPoseGetsOne) {
  sim_.ingest();
  const SetId late = sim_.set.id;
  sim_.advance(2);
  EXPECT_FALSE(camera().frame_at(late)->valid());
  edit_.place_past(camera(), *camera().frame_at(late), sim_.id, test::looking({2, 0, 0}));
  EXPECT_EQ(camera().frame_at(late)->map, sim_.id);
  EXPECT_THAT(camera().frame_at(late)->cam_from_world, PoseNear(test::looking({2, 0, 0}), 1e-12, 1e-12));
  EXPECT_EQ(camera().frames_in_map(sim_.id), 7);
}

TEST_F(CameraPenTest, ImagesThatAreDatedWronglyAreReportedAndLeftAlone) {
  const MapEdit before = edit_;
  edit_.note_misdated(camera(), 0.25, kCam1);
  const std::vector<Event> told = events(EventKind::kCameraMisdated);
  ASSERT_EQ(told.size(), 1U);
  EXPECT_EQ(told[0].camera, kCam0);
  EXPECT_EQ(told[0].figures, (Figures{0.25, 1}));
  test::expect_same(sim_.map, before.map());
}

}  // namespace
}  // namespace coslam::camera_pen_test
