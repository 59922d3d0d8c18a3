// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/associate/cull.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/support/map_checks.h"
#include "tests/support/sim_map.h"

namespace coslam::cull_test {
namespace {

class CullTest : public testing::Test {
 protected:
  CullTest() {
    sim_.advance();
    sim_.add_points();
  }
  CullReport step(int sets = 1) {
    sim_.advance(sets);
    return cull(sim_.edit, sim_.set, config_);
  }
  PointId make(int views) {
    const MapPoint& p = sim_.create({0, 0, 5}, 1);
    for (int i = 0; i < views; ++i) sim_.edit.see(p);
    return p.id;
  }
  int probation() const { return static_cast<int>(sim_.map.sets_in(config_.probation_s)); }

  const CullConfig config_;
  const test::SimWorld world_{{.points = 60}};
  test::SimMap sim_{world_, test::paths_side_by_side(1)};
};

TEST_F(CullTest, RemovesWhatFailedItsProbation) {
  const PointId poor = make(3), good = make(12);
  EXPECT_EQ(step(probation() - 1).removed, 0);
  EXPECT_GE(step().removed, 1);
  EXPECT_EQ(sim_.map.find(poor), nullptr);
  EXPECT_NE(sim_.map.find(good), nullptr);
  test::expect_consistent(sim_.map);
}

TEST_F(CullTest, TellsHowOftenWhatItRemovesWasSeen) {
  const PointId poor = make(3);
  test::forget(sim_.edit.journal());
  step(probation() + 2);
  const auto& events = sim_.edit.journal().events();
  const auto removed = std::ranges::find_if(
      events, [&](const Event& e) { return e.kind == EventKind::kPointRemoved && e.point == poor; });
  ASSERT_NE(removed, events.end());
  EXPECT_EQ(removed->why, Why::kSeenTooLittle);
  EXPECT_EQ(removed->figures, (Figures{3, probation() + 2.0})) << "views, and the age in sets";
}

TEST_F(CullTest, LeavesPointsThatATrackFollows) {
  for (const auto& [id, p] : sim_.map.points()) ASSERT_EQ(p.views, 0U);
  std::vector<PointId> followed;
  sim_.advance(probation() + 1);
  for (const auto& [id, p] : sim_.map.points()) {
    if (!p.bound.empty()) followed.push_back(id);
  }
  ASSERT_GT(followed.size(), 20U);
  cull(sim_.edit, sim_.set, config_);
  for (const PointId id : followed) EXPECT_NE(sim_.map.find(id), nullptr);
}

TEST_F(CullTest, WhatStoodItsProbationIsNotLookedAtAgain) {
  const PointId good = make(12);
  step(probation());
  EXPECT_FALSE(sim_.map.untracked_points().contains(good));
  EXPECT_NE(sim_.map.find(good), nullptr);
  step(100);
  EXPECT_NE(sim_.map.find(good), nullptr);
}

TEST_F(CullTest, AnOldPointThatLosesItsLastTrackIsJudgedAtOnce) {
  const ServerTrack* track = nullptr;
  for (const auto& [id, t] : sim_.map.camera(CameraId(0)).tracks) track = t.bound() ? &t : track;
  ASSERT_NE(track, nullptr);
  const TrackId id = track->id;
  const PointId point = track->point;
  sim_.advance(probation() + 1);
  const auto at = sim_.map.camera(CameraId(0)).tracks.find(id);
  if (at != sim_.map.camera(CameraId(0)).tracks.end()) {
    sim_.edit.unbind(CameraId(0), at->second, Why::kStray);
  }
  EXPECT_TRUE(sim_.map.untracked_points().contains(point));
  cull(sim_.edit, sim_.set, config_);
  EXPECT_EQ(sim_.map.find(point), nullptr);
}

TEST_F(CullTest, LeavesPointsThatHadNoImageToBeSeenIn) {
  test::SimMap sim(world_, test::paths_side_by_side(1));
  sim.period_ns = 1'000'000'000;
  sim.advance(5);
  const PointId unseen = sim.create({0, 0, 5}, 1).id;
  sim.advance(3);
  cull(sim.edit, sim.set, {});
  EXPECT_NE(sim.map.find(unseen), nullptr);
}

TEST(CullStill, KeepsFewPatchesTheFirstAndTheNewest) {
  const test::SimWorld world({.points = 60});
  test::SimMap sim(world, {test::still_path(test::looking({0, 0, 0}))});
  sim.advance();
  sim.add_points();
  const MapPoint& p = sim.map.points().begin()->second;
  const BoundTrack seen = p.bound.front();
  const auto first = sim.set.id.value + 1;
  for (int i = 0; i < 50; ++i) {
    sim.advance(1, true);
    sim.edit.give_patch(p, seen.camera, sim.map.track(seen));
  }
  ASSERT_EQ(p.patches.size(), 50U);
  cull(sim.edit, sim.set, {});
  EXPECT_EQ(p.patches.size(), kPatchesOfPoint);
  EXPECT_EQ(p.patches.front().set, SetId(first));
  EXPECT_EQ(p.patches.back().set, sim.set.id);
}

}  // namespace
}  // namespace coslam::cull_test
