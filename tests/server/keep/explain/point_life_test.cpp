// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <limits>

#include "tests/server/keep/explain/story.h"

// Lives that are cut off, short or impossible. Those of whole runs are in explain_test.cpp.
namespace coslam::explain::point_life_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

using PointLife = Story;

TEST_F(PointLife, OfALogThatBeginsLateIsWhatTheLogHas) {
  became(5, 7, PointPhase::kStatic, Why::kStoodTheTrial, {6, 0});
  removed(6, 7, Why::kSeenTooLittle, {3, 30});
  EXPECT_EQ(point(7).find("     5.000 s  It became static"), 0U);
  EXPECT_THAT(point_at(7, 5.5), HasSubstr("At 5.500 s point 7 was static.\n"));
  EXPECT_THAT(point_at(7, 6), HasSubstr("At 6.000 s point 7 was no longer in the map.\n"));
}

TEST_F(PointLife, OfAPointThatNobodyMadeAndThatBecamePartOfAnotherGoesOn) {
  made(1, 3, PointPhase::kStatic, Why::kTwoCamerasNow, {2, 0.01});
  fused(4, 3, 4);
  EXPECT_THAT(point(4), HasSubstr("4.000 s  It became part of point 3"));
  EXPECT_THAT(point(3), HasSubstr("Point 4, made at 4.000 s, became part of it"));
  EXPECT_EQ(life_of_point(log(), PointId(4))->last, PointId(3));
}

TEST_F(PointLife, TracksThatLeftBeforeDoNotComeAlong) {
  made(1, 3, PointPhase::kStatic, Why::kTwoCamerasNow, {2, 0.01});
  made(1, 4, PointPhase::kStatic, Why::kTwoCamerasNow, {2, 0.01});
  track(1, EventKind::kTrackBound, cam0_, 1, 4, Why::kMadeFromIt);
  track(1, EventKind::kTrackBound, cam1_, 2, 4, Why::kMadeFromIt);
  track(2, EventKind::kTrackUnbound, cam0_, 1, 4, Why::kOutsideGate, {3, 5});
  fused(3, 3, 4);
  EXPECT_THAT(point_at(3, 3), HasSubstr("followed by cam1/2.\n"));
  EXPECT_THAT(point_at(3, 3), Not(HasSubstr("cam0/1")));
}

TEST_F(PointLife, TheMapsOfOthersDoNotMoveIt) {
  made(1, 7, PointPhase::kStatic, Why::kStartOfMap, {20, 0}, 2);
  map(2, EventKind::kMapMoved, 1, Why::kLoopClosed, {1.1, 0});
  map(3, EventKind::kMapMerged, 1, Why::kMapsMet, {0.5, 0}).from = MapId(3);
  removed(4, 7, Why::kTooFewViews, {1, 0});
  map(5, EventKind::kMapMoved, 2, Why::kLoopClosed, {1.2, 0});
  EXPECT_EQ(life_of_point(log(), PointId(7))->entries.size(), 4U) << "made and removed, with the map it was in";
}

TEST_F(PointLife, AMissWithoutAFigureHasNone) {
  made(1, 7, PointPhase::kStatic, Why::kTwoCamerasNow, {2, 0.01});
  track(2, EventKind::kTrackMissed, cam0_, 1, 7, Why::kOutsideGate, {1, std::numeric_limits<double>::quiet_NaN()});
  EXPECT_THAT(point(7), HasSubstr("cam0/1 missed the gate by ? sigma"));
}

// What no run writes, but a file may hold.
TEST_F(PointLife, PointsThatBecamePartOfEachOtherHaveAnEnd) {
  made(1, 3, PointPhase::kStatic, Why::kTwoCamerasNow, {2, 0.01});
  made(1, 4, PointPhase::kStatic, Why::kTwoCamerasNow, {2, 0.01});
  fused(2, 3, 4);
  fused(3, 4, 3);
  fused(4, 3, 4);
  for (const int id : {3, 4}) {
    const auto life = life_of_point(log(), PointId(static_cast<std::uint32_t>(id)));
    ASSERT_TRUE(life);
    EXPECT_LT(life->entries.size(), 40U);
    EXPECT_FALSE(life_text(log(), *life).empty());
  }
}

TEST_F(PointLife, APointThatBecamePartOfItselfHasAnEnd) {
  fused(1, 3, 3);
  made(2, 3, PointPhase::kStatic, Why::kTwoCamerasNow, {2, 0.01});
  ASSERT_TRUE(life_of_point(log(), PointId(3)));
}

}  // namespace
}  // namespace coslam::explain::point_life_test
