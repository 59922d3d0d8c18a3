// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/map/past_pen.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "tests/support/map_checks.h"
#include "tests/support/sim_map.h"

// What leaves the memory of a long run, and what stays. Whole runs that forget are in past/forget_test.cpp.
namespace coslam::past_pen_test {
namespace {

constexpr CameraId kCam0(0), kCam1(1);

class PastPenTest : public testing::Test {
 protected:
  const MapCamera& camera(CameraId id) const { return sim_.map.camera(id); }
  // Sets in which cameras have no pose, beside those with one.
  void advance_lost(int sets) {
    for (int i = 0; i < sets; ++i) sim_.ingest();
  }
  TimeNs time_of(std::uint32_t set) const { return sim_.period_ns * set; }
  long observations_of(SetId set, CameraId camera) const {
    long count = 0;
    for (const auto& [id, p] : sim_.map.points()) {
      count += std::ranges::count_if(p.key_observations,
                                     [&](const KeyObservation& o) { return o.set == set && o.camera == camera; });
    }
    return count;
  }

  const test::SimWorld world_{{.points = 60}};
  test::SimMap sim_{world_, test::paths_side_by_side(2)};
  MapEdit& edit_ = sim_.edit;
};
using PastPenDeathTest = PastPenTest;

TEST_F(PastPenTest, AForgottenViewLeavesNoObservationAndTheOthersStay) {
  sim_.advance(8);
  sim_.add_points();
  for (const std::uint32_t set : {2U, 5U}) edit_.add_key_frame(SetId(set));
  const long of_other_camera = observations_of(SetId(2), kCam1), of_other_set = observations_of(SetId(5), kCam0);
  ASSERT_GT(observations_of(SetId(2), kCam0), 10);
  edit_.forget_view(SetId(2), kCam0);
  EXPECT_EQ(observations_of(SetId(2), kCam0), 0);
  EXPECT_EQ(observations_of(SetId(2), kCam1), of_other_camera);
  EXPECT_EQ(observations_of(SetId(5), kCam0), of_other_set);
  EXPECT_TRUE(sim_.map.points_observed_in({{SetId(2), kCam0}}).empty());
  test::expect_consistent(sim_.map);
}

TEST_F(PastPenTest, AKeyFrameGoesWithItsLastView) {
  sim_.advance(8);
  sim_.add_points();
  for (const std::uint32_t set : {2U, 5U}) edit_.add_key_frame(SetId(set));
  edit_.forget_view(SetId(2), kCam0);
  EXPECT_TRUE(sim_.map.is_key_frame(SetId(2))) << "the other camera still has its view";
  edit_.forget_view(SetId(2), kCam1);
  EXPECT_FALSE(sim_.map.is_key_frame(SetId(2)));
  EXPECT_TRUE(sim_.map.is_key_frame(SetId(5)));
  edit_.forget_view(SetId(2), kCam1);
  EXPECT_EQ(sim_.map.key_frames().size(), 1U) << "a second time there is nothing to forget";
}

TEST_F(PastPenTest, KeyImagesAndSparedOnesAreForgottenToo) {
  sim_.advance(4);
  sim_.add_points();
  const SetId image = sim_.set.id;
  edit_.add_key_image(image, kCam0);
  sim_.advance(1);
  const SetId frame = sim_.set.id;
  edit_.add_key_frame(frame, {kCam1});
  sim_.advance(1);
  edit_.forget_view(image, kCam0);
  EXPECT_TRUE(sim_.map.key_images().empty());
  EXPECT_EQ(observations_of(image, kCam0), 0);
  ASSERT_EQ(sim_.map.skipped_key_images().size(), 1U);
  edit_.forget_view(frame, kCam1);
  EXPECT_TRUE(sim_.map.skipped_key_images().empty());
  EXPECT_TRUE(sim_.map.is_key_frame(frame)) << "which the first camera sees";
}

TEST_F(PastPenTest, APointThatIsGoneMeanwhileIsNoObstacle) {
  sim_.advance(4);
  sim_.add_points();
  edit_.add_key_frame(SetId(1));
  const std::vector<const MapPoint*> seen = sim_.map.points_observed_at({SetId(1)});
  ASSERT_GT(seen.size(), 4U);
  const PointId removed = seen[0]->id, fused = seen[1]->id, kept = seen[2]->id;
  edit_.remove_point(*seen[0], Why::kTooFewViews);
  edit_.fuse(kept, fused, Why::kOneCorner);
  for (const CameraId c : {kCam0, kCam1}) edit_.forget_view(SetId(1), c);
  EXPECT_EQ(sim_.map.find(removed), nullptr);
  EXPECT_TRUE(sim_.map.find(kept)->key_observations.empty());
  EXPECT_TRUE(sim_.map.points_observed_at({SetId(1)}).empty());
}

TEST_F(PastPenDeathTest, WhatIsSeenNowIsNoPast) {
  sim_.advance(2);
  EXPECT_DEATH(edit_.forget_view(sim_.set.id, kCam0), "what is seen now is no past");
  EXPECT_DEATH(edit_.forget_frame(camera(kCam0), SetId(0)), "only what was given out");
}

TEST_F(PastPenTest, FramesThatLeaveAreCountedWhereTheyWere) {
  sim_.advance(3);
  advance_lost(3);  // sets 3 to 5
  sim_.advance(6);
  advance_lost(8);  // from set 12 on
  const int placed = camera(kCam0).frames_in_map(sim_.id);
  const std::size_t ever = camera(kCam0).frames_ever();
  const std::vector<FramePose> block = edit_.take_frames(camera(kCam0), SetId(10), {SetId(0)});
  ASSERT_EQ(block.size(), 10U);
  for (std::uint32_t i = 0; i < 10; ++i) {
    EXPECT_EQ(block[i].set, SetId(i));
    EXPECT_TRUE(block[i].held.empty()) << "what it held is for poses that are solved again";
  }
  EXPECT_EQ(camera(kCam0).frames.size(), 1U + 10U);
  EXPECT_NE(camera(kCam0).frame_at(SetId(0)), nullptr);
  EXPECT_EQ(camera(kCam0).frames_in_map(sim_.id), placed);
  EXPECT_EQ(camera(kCam0).frames_ever(), ever);
  EXPECT_EQ(camera(kCam0).past.first_ns, time_of(0));
  using Lost = std::vector<std::pair<TimeNs, TimeNs>>;
  EXPECT_EQ(camera(kCam0).past.lost, Lost({{time_of(3), time_of(6)}}));
  EXPECT_EQ(edit_.take_frames(camera(kCam0), SetId(15), {}).size(), 5U) << "none twice";
  EXPECT_EQ(camera(kCam0).past.lost, Lost({{time_of(3), time_of(6)}, {time_of(12), time_of(14)}}));
  EXPECT_EQ(camera(kCam0).frames_in_map(sim_.id), placed);
  EXPECT_EQ(camera(kCam0).frames_ever(), ever);
  EXPECT_EQ(camera(kCam1).frames.size(), 20U) << "of the other camera nothing was taken";
}

TEST_F(PastPenTest, TakingAgainTakesNothing) {
  sim_.advance(6);
  edit_.take_frames(camera(kCam0), SetId(4), {SetId(1)});
  const PastFramesCount before = camera(kCam0).past;
  EXPECT_TRUE(edit_.take_frames(camera(kCam0), SetId(4), {}).empty());
  EXPECT_EQ(camera(kCam0).past.frames, before.frames);
  EXPECT_EQ(camera(kCam0).past.placed, before.placed);
  EXPECT_NE(camera(kCam0).frame_at(SetId(1)), nullptr) << "an anchor stays until it is forgotten";
  edit_.forget_frame(camera(kCam0), SetId(1));
  EXPECT_EQ(camera(kCam0).frame_at(SetId(1)), nullptr);
  EXPECT_EQ(camera(kCam0).frames_ever(), 6U);
}

TEST_F(PastPenTest, OfPatchesTheFirstStaysAndThoseWhoseFrameDoes) {
  sim_.advance(1, true);
  int shared = 0;
  while (!sim_.all_follow(shared)) ++shared;
  const MapPoint& p = sim_.add_point(shared);
  ASSERT_EQ(p.patches.size(), 2U);
  sim_.advance(8, true);
  edit_.give_patch(p, kCam0, *sim_.track_of(kCam0, shared));
  for (const CameraId c : {kCam0, kCam1}) edit_.take_frames(camera(c), SetId(5), {});
  edit_.forget_patches(p);
  ASSERT_EQ(p.patches.size(), 2U);
  EXPECT_EQ(p.patches[0].set, SetId(0));
  EXPECT_EQ(p.patches[1].set, sim_.set.id);
  const MapPoint& bare = sim_.create({0, 0, 5});
  edit_.forget_patches(bare);
  EXPECT_TRUE(bare.patches.empty());
}

TEST_F(PastPenTest, WhatTracksSawIsForgottenUnlessItIsAllTheyHave) {
  sim_.advance(4);
  for (int i = 0; i < 4; ++i) {  // only the first camera goes on
    sim_.look();
    sim_.set.frames.pop_back();
    sim_.take();
  }
  edit_.forget_seen(SetId(6));
  for (const auto& [id, t] : camera(kCam0).tracks) EXPECT_GE(t.seen.front().set, SetId(6));
  ASSERT_FALSE(camera(kCam1).tracks.empty());
  for (const auto& [id, t] : camera(kCam1).tracks) EXPECT_FALSE(t.seen.empty());
}

TEST_F(PastPenTest, PathsLeaveUpToASetInTheirOrder) {
  sim_.advance(8);
  const PointId a = sim_.create({0, 0, 5}, 0.01, PointPhase::kMoving).id,
                b = sim_.create({1, 0, 5}, 0.01, PointPhase::kMoving).id;
  for (std::uint32_t set = 0; set < 8; ++set) {
    edit_.record_motion(a, {SetId(set), time_of(set), {}});
    if (set < 3) edit_.record_motion(b, {SetId(set), time_of(set), {}});
  }
  const auto taken = edit_.take_motions(SetId(5));
  std::vector<std::pair<PointId, std::uint32_t>> got, expected;
  for (const auto& [id, s] : taken) got.emplace_back(id, s.set.value);
  for (std::uint32_t set = 0; set < 5; ++set) expected.emplace_back(a, set);
  for (std::uint32_t set = 0; set < 3; ++set) expected.emplace_back(b, set);
  EXPECT_EQ(got, expected);
  ASSERT_TRUE(sim_.map.motions().contains(a));
  EXPECT_EQ(sim_.map.motions().at(a).front().set, SetId(5));
  EXPECT_FALSE(sim_.map.motions().contains(b)) << "nothing of it is left";
  EXPECT_TRUE(edit_.take_motions(SetId(5)).empty());
}

}  // namespace
}  // namespace coslam::past_pen_test
