// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/correct/local_map.h"

#include <gtest/gtest.h>

#include "tests/support/matchers.h"

namespace coslam::local_map_test {
namespace {

using test::VectorNear;

constexpr RunId kAgentRun(5), kServerRun(9);

MapPatch patch_of(std::uint32_t sequence, bool snapshot = false) {
  MapPatch p;
  p.server_run = kServerRun;
  p.agent_run = kAgentRun;
  p.sequence = sequence;
  p.snapshot = snapshot;
  return p;
}

BoundPoint bound(std::uint32_t track, const Eigen::Vector3f& position = {1, 2, 3}) {
  BoundPoint b{TrackId(track), PointId(track + 100)};
  b.position = position;
  b.covariance << 1, 0, 0, 4, 0, 9;
  return b;
}

class LocalMapTest : public testing::Test {
 protected:
  LocalMapTest() {
    MapPatch first = patch_of(1, true);
    first.updated = {bound(1), bound(2, {4, 5, 6})};
    EXPECT_TRUE(map_.apply(first).accepted);
  }
  LocalMap map_{kAgentRun};
};

TEST_F(LocalMapTest, TheFirstPatchIsANewServer) {
  LocalMap map(kAgentRun);
  EXPECT_EQ(map.applied_sequence(), 0U);
  const PatchEffect effect = map.apply(patch_of(1, true));
  EXPECT_TRUE(effect.accepted);
  EXPECT_TRUE(effect.new_server);
  EXPECT_EQ(map.server_run(), kServerRun);
  EXPECT_EQ(map.applied_sequence(), 1U);
}

TEST_F(LocalMapTest, HoldsWhatItWasTold) {
  ASSERT_NE(map_.find(TrackId(2)), nullptr);
  EXPECT_EQ(map_.find(TrackId(2))->point, PointId(102));
  EXPECT_EQ(map_.find(TrackId(2))->position, Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(map_.find(TrackId(2))->covariance, Eigen::Vector3d(1, 4, 9).asDiagonal().toDenseMatrix());
  EXPECT_EQ(map_.find(TrackId(3)), nullptr);
}

TEST_F(LocalMapTest, UpdatesAndUnbinds) {
  MapPatch p = patch_of(2);
  p.updated = {bound(1, {7, 7, 7}), bound(3)};
  p.unbound = {TrackId(2), TrackId(77)};  // 77 was never known
  const PatchEffect effect = map_.apply(p);
  EXPECT_TRUE(effect.accepted);
  EXPECT_FALSE(effect.new_server);
  EXPECT_FALSE(effect.rebase);
  EXPECT_EQ(map_.size(), 2U);
  EXPECT_EQ(map_.find(TrackId(1))->position, Eigen::Vector3d(7, 7, 7));
  EXPECT_EQ(map_.find(TrackId(2)), nullptr);
}

TEST_F(LocalMapTest, APatchComesTwiceOrLate) {
  MapPatch second = patch_of(2);
  second.updated = {bound(1, {7, 7, 7})};
  ASSERT_TRUE(map_.apply(second).accepted);
  MapPatch again = second;
  again.updated = {bound(1, {8, 8, 8})};
  EXPECT_FALSE(map_.apply(again).accepted);
  EXPECT_FALSE(map_.apply(patch_of(1, true)).accepted);
  EXPECT_EQ(map_.find(TrackId(1))->position, Eigen::Vector3d(7, 7, 7));
  EXPECT_FALSE(map_.wants_snapshot());
}

TEST_F(LocalMapTest, AGapAsksForASnapshotAndWaitsForIt) {
  MapPatch third = patch_of(3);
  third.updated = {bound(9)};
  EXPECT_FALSE(map_.apply(third).accepted);
  EXPECT_TRUE(map_.wants_snapshot());
  EXPECT_EQ(map_.find(TrackId(9)), nullptr);
  EXPECT_EQ(map_.applied_sequence(), 1U);
  EXPECT_FALSE(map_.apply(patch_of(4)).accepted);
  MapPatch fifth = patch_of(5, true);
  fifth.updated = {bound(4)};
  EXPECT_TRUE(map_.apply(fifth).accepted);
  EXPECT_FALSE(map_.wants_snapshot());
  EXPECT_EQ(map_.size(), 1U) << "a snapshot is everything";
  EXPECT_TRUE(map_.apply(patch_of(6)).accepted);
}

TEST_F(LocalMapTest, AnotherRunsPatchIsIgnored) {
  MapPatch p = patch_of(2);
  p.agent_run = RunId(6);
  p.unbound = {TrackId(1)};
  const PatchEffect effect = map_.apply(p);
  EXPECT_FALSE(effect.accepted);
  EXPECT_FALSE(effect.new_server);
  EXPECT_EQ(map_.size(), 2U);
}

TEST_F(LocalMapTest, ANewServerStartsFromNothing) {
  MapPatch p = patch_of(1, true);
  p.server_run = RunId(10);
  p.epoch = MapEpoch(0);
  p.updated = {bound(3)};
  const PatchEffect effect = map_.apply(p);
  EXPECT_TRUE(effect.accepted);
  EXPECT_TRUE(effect.new_server);
  EXPECT_EQ(map_.size(), 1U);
  EXPECT_EQ(map_.server_run(), RunId(10));
}

TEST_F(LocalMapTest, JoiningANewServerInTheMiddleTakesASnapshot) {
  MapPatch p = patch_of(8);
  p.server_run = RunId(10);
  p.updated = {bound(3)};
  const PatchEffect effect = map_.apply(p);
  EXPECT_FALSE(effect.accepted);
  EXPECT_TRUE(effect.new_server);
  EXPECT_TRUE(map_.wants_snapshot());
  EXPECT_EQ(map_.size(), 0U) << "the old server's points mean nothing";
}

// A server that was killed comes back with its map as it was saved, some movements of the map ago.
class LocalMapOfAServerThatGoesOn : public LocalMapTest {
 protected:
  LocalMapOfAServerThatGoesOn() {
    for (const std::uint32_t epoch : {1U, 2U, 3U}) {
      MapPatch p = patch_of(epoch + 1);
      p.epoch = MapEpoch(epoch);
      p.new_from_old = {1.0 + 0.1 * epoch, so3_exp({0.1, 0, 0.2 * epoch}), {1.0 * epoch, 2, 3}};
      EXPECT_TRUE(map_.apply(p).accepted);
      then_.push_back(map_.find(TrackId(2))->position);
    }
  }
  MapPatch first_of_the_next(MapEpoch from) const {
    MapPatch p = patch_of(1, true);
    p.server_run = RunId(10);
    p.continues = ContinuedMap{kServerRun, from};
    p.epoch = from;
    return p;
  }
  std::vector<Eigen::Vector3d> then_;  // where a point was in epochs 1, 2, 3
};

TEST_F(LocalMapOfAServerThatGoesOn, WhatIsKnownMovesBackToWhatWasSaved) {
  MapPatch p = first_of_the_next(MapEpoch(1));
  p.updated = {bound(3)};
  const PatchEffect effect = map_.apply(p);
  EXPECT_TRUE(effect.new_server);
  EXPECT_TRUE(effect.goes_on);
  ASSERT_TRUE(effect.rebase);
  EXPECT_THAT(*effect.rebase * then_[2], VectorNear(then_[0], 1e-9));
  EXPECT_THAT(map_.find(TrackId(2))->position, VectorNear(then_[0], 1e-9));
  EXPECT_TRUE(map_.find(TrackId(2))->former);
  ASSERT_NE(map_.find(TrackId(3)), nullptr);
  EXPECT_FALSE(map_.find(TrackId(3))->former);
  EXPECT_EQ(map_.epoch(), MapEpoch(1));
  EXPECT_EQ(map_.server_run(), RunId(10));
  EXPECT_EQ(map_.applied_sequence(), 1U);
}

TEST_F(LocalMapOfAServerThatGoesOn, AndOnToWhereThatServerHasMovedIt) {
  MapPatch p = first_of_the_next(MapEpoch(2));
  p.epoch = MapEpoch(5);
  p.new_from_old = {2.0, Eigen::Quaterniond::Identity(), {0, 0, 1}};
  const PatchEffect effect = map_.apply(p);
  ASSERT_TRUE(effect.rebase);
  EXPECT_THAT(*effect.rebase * then_[2], VectorNear(p.new_from_old * then_[1], 1e-9));
  EXPECT_THAT(map_.find(TrackId(2))->position, VectorNear(p.new_from_old * then_[1], 1e-9));
  EXPECT_EQ(map_.epoch(), MapEpoch(5));
}

TEST_F(LocalMapOfAServerThatGoesOn, NothingIsKeptWhenTheWayBackIsUnknown) {
  MapPatch of_another = first_of_the_next(MapEpoch(2));
  of_another.continues->server_run = RunId(77);
  for (const MapPatch& p : {first_of_the_next(MapEpoch(7)), of_another}) {
    LocalMap map = map_;
    const PatchEffect effect = map.apply(p);
    EXPECT_TRUE(effect.new_server);
    EXPECT_FALSE(effect.goes_on);
    EXPECT_EQ(map.size(), 0U);
  }
  // A snapshot may speak of another map: what was before it is not on the way.
  MapPatch snapshot = patch_of(5, true);
  snapshot.epoch = MapEpoch(4);
  ASSERT_TRUE(map_.apply(snapshot).accepted);
  EXPECT_FALSE(map_.apply(first_of_the_next(MapEpoch(3))).goes_on);
}

TEST_F(LocalMapTest, ANewEpochMovesTheWholeMapAtOnce) {
  MapPatch p = patch_of(2);
  p.epoch = MapEpoch(1);
  p.new_from_old = {2.0, so3_exp({0, 0, 1.5707963267948966}), {10, 0, 0}};
  p.updated = {bound(1, {7, 7, 7})};  // is given in the new epoch already
  const PatchEffect effect = map_.apply(p);
  ASSERT_TRUE(effect.rebase);
  EXPECT_EQ(effect.rebase->scale, 2.0);
  EXPECT_EQ(map_.epoch(), MapEpoch(1));
  EXPECT_EQ(map_.find(TrackId(1))->position, Eigen::Vector3d(7, 7, 7));
  EXPECT_THAT(map_.find(TrackId(2))->position, VectorNear(Eigen::Vector3d(0, 8, 12), 1e-9));
  const Eigen::Matrix3d turned = Eigen::Vector3d(16, 4, 36).asDiagonal();
  EXPECT_LT((map_.find(TrackId(2))->covariance - turned).norm(), 1e-9);
}

TEST_F(LocalMapTest, ASimilarityAcrossAGapIsNotApplied) {
  MapPatch p = patch_of(4, true);
  p.epoch = MapEpoch(3);
  p.new_from_old = {2.0, Eigen::Quaterniond::Identity(), {1, 1, 1}};
  p.placed = PlacedPose{FrameId(12), Rigid3()};
  const PatchEffect effect = map_.apply(p);
  EXPECT_TRUE(effect.accepted);
  EXPECT_FALSE(effect.rebase) << "epochs between were missed: the placed pose tells";
  EXPECT_TRUE(effect.placed);
  EXPECT_EQ(map_.epoch(), MapEpoch(3));
}

TEST_F(LocalMapTest, ALensHoldsUntilAnotherOrASnapshotWithoutOne) {
  LensCorrection lens;
  lens.values[0] = 0.03;
  MapPatch patch = patch_of(2);
  patch.lens = lens;
  EXPECT_EQ(map_.apply(patch).lens, lens);
  EXPECT_FALSE(map_.apply(patch_of(3)).lens.has_value()) << "as before";
  EXPECT_EQ(map_.apply(patch_of(4, true)).lens, LensCorrection()) << "as calibrated";
}

TEST_F(LocalMapTest, KeepsOnlyLiveTracks) {
  const Eigen::Vector2f px(10, 20);
  map_.keep_only({{TrackId(2), px}, {TrackId(5), px}});
  EXPECT_EQ(map_.size(), 1U);
  EXPECT_NE(map_.find(TrackId(2)), nullptr);
  map_.keep_only({});
  EXPECT_EQ(map_.size(), 0U);
}

TEST_F(LocalMapTest, PassesRequestsOn) {
  MapPatch p = patch_of(2);
  p.patch_requests = {TrackId(1), TrackId(2)};
  p.descriptor_request = DescriptorRequest::kEverywhere;
  const PatchEffect effect = map_.apply(p);
  EXPECT_EQ(effect.patch_requests, p.patch_requests);
  EXPECT_EQ(effect.descriptor_request, DescriptorRequest::kEverywhere);
}

}  // namespace
}  // namespace coslam::local_map_test
