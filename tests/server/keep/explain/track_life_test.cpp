// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <limits>

#include "tests/server/keep/explain/story.h"

// Beginnings and ends, and what befell the point meanwhile. The states of a track are in explain_test.cpp.
namespace coslam::explain::track_life_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

using TrackLife = Story;

constexpr const char *kBegan = "Its camera began to follow it",
                     *kBeganAt0 = "     0.000 s  Its camera began to follow it",
                     *kBeganAt1 = "     1.000 s  Its camera began to follow it";

TEST_F(TrackLife, ItsBeginningIsToldWhereTheLogHasThatFrameSet) {
  camera(1, EventKind::kCameraPlaced, 1, Why::kStartedAlone, {5, 0});
  track(2, EventKind::kTrackEnded, cam0_, 9, 0, Why::kImageEnded, {11, 0});  // sets 10 to 20
  track(2, EventKind::kTrackEnded, cam0_, 8, 0, Why::kImageEnded, {10, 0});
  EXPECT_THAT(track_of(cam0_, 9), HasSubstr(kBeganAt1));
  EXPECT_THAT(track_of(cam0_, 8), Not(HasSubstr(kBegan))) << "nothing happened then";
}

TEST_F(TrackLife, ALengthThatCannotBeTellsNoBeginning) {
  camera(0, EventKind::kCameraPlaced, 1, Why::kStartedAlone, {5, 0});
  int id = 1;
  for (const double sets : {0.0, -5.0, 1e300, 23.0, std::numeric_limits<double>::quiet_NaN()}) {
    track(2, EventKind::kTrackEnded, cam0_, id, 0, Why::kImageEnded, {sets, 0});
    EXPECT_THAT(track_of(cam0_, id), Not(HasSubstr(kBegan))) << sets;
    ++id;
  }
  track(2, EventKind::kTrackEnded, cam0_, id, 0, Why::kImageEnded, {21, 0});
  EXPECT_THAT(track_of(cam0_, id), HasSubstr(kBeganAt0)) << "since the first set";
}

TEST_F(TrackLife, ATrackOfOneImageBeginsAndEndsWithIt) {
  track(2, EventKind::kTrackEnded, cam0_, 9, 0, Why::kImageEnded, {1, 0});
  EXPECT_THAT(track_of(cam0_, 9), HasSubstr(kBegan));
  EXPECT_FALSE(life_of_track(log(), {cam0_, TrackId(9)})->alive);
}

TEST_F(TrackLife, FollowsItsPointThroughSeveralOthers) {
  for (const int point : {3, 4, 5}) made(1, point, PointPhase::kStatic, Why::kTwoCamerasNow, {2, 0.01});
  track(1, EventKind::kTrackBound, cam0_, 9, 5, Why::kMadeFromIt);
  fused(2, 4, 5);
  became(2.5, 5, PointPhase::kMoving, Why::kSeenElsewhere, {2, 0});  // of a point that is no more
  fused(3, 3, 4);
  became(4, 3, PointPhase::kMoving, Why::kSeenElsewhere, {2, 0});
  const std::string text = track_of(cam0_, 9);
  EXPECT_THAT(text, HasSubstr("2.000 s  Its point 5 became part of point 4"));
  EXPECT_THAT(text, HasSubstr("3.000 s  Its point 4 became part of point 3"));
  EXPECT_THAT(text, HasSubstr("4.000 s  Its point 3 became moving"));
  EXPECT_THAT(text, Not(HasSubstr("2.500 s")));
  EXPECT_THAT(track_at(cam0_, 9, 5), HasSubstr("was moving, with point 3.\n"));
  EXPECT_TRUE(life_of_track(log(), {cam0_, TrackId(9)})->alive);
}

TEST_F(TrackLife, WhatBefellItsPointAfterItLeftIsNotItsOwn) {
  made(1, 5, PointPhase::kStatic, Why::kTwoCamerasNow, {2, 0.01});
  track(1, EventKind::kTrackBound, cam0_, 9, 5, Why::kMadeFromIt);
  track(2, EventKind::kTrackUnbound, cam0_, 9, 5, Why::kOutsideGate, {3, 5});
  became(3, 5, PointPhase::kMoving, Why::kSeenElsewhere, {2, 0});
  EXPECT_THAT(track_of(cam0_, 9), Not(HasSubstr("3.000 s")));
  EXPECT_THAT(track_at(cam0_, 9, 4), HasSubstr("was unmapped.\n"));
}

TEST_F(TrackLife, MissesInSuccessionAreOneSentence) {
  track(1, EventKind::kTrackBound, cam0_, 9, 5, Why::kRegistered, {1, 0.9});
  for (int i = 0; i < 3; ++i) track(2 + i, EventKind::kTrackMissed, cam0_, 9, 5, Why::kOutsideGate, {1, 3.0 + i});
  EXPECT_THAT(track_of(cam0_, 9), HasSubstr("2.000 s  It missed the gate by 3 sigma, the first of 3 times until 4.000 "
                                            "s, by up to 5 sigma.\n"));
}

TEST_F(TrackLife, TracksOfTwoCamerasMayHaveOneNumber) {
  track(1, EventKind::kTrackBound, cam0_, 9, 5, Why::kRegistered, {1, 0.9});
  EXPECT_EQ(life_of_track(log(), {cam1_, TrackId(9)}), std::nullopt);
  track(2, EventKind::kTrackBound, cam1_, 9, 6, Why::kRegistered, {1, 0.9});
  EXPECT_THAT(track_of(cam1_, 9), Not(HasSubstr("point 5")));
}

}  // namespace
}  // namespace coslam::explain::track_life_test
