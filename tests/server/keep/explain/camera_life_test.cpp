// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "tests/server/keep/explain/story.h"

// Restarts, findings about images, and maps of others. A whole life is in explain_test.cpp.
namespace coslam::explain::camera_life_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class CameraLife : public Story {
 protected:
  std::string text() { return life_text(log(), *life_of_camera(log(), cam0_)); }
  std::string state(double t_s) {
    const std::string told = told_at(log(), *life_of_camera(log(), cam0_), to_ns(t_s));
    return told.substr(0, told.find('\n'));
  }
};

TEST_F(CameraLife, OfACameraThatNoEventNamesIsNone) {
  track(1, EventKind::kTrackBound, cam0_, 9, 5, Why::kRegistered, {1, 0.9});
  EXPECT_EQ(life_of_camera(log(), cam0_), std::nullopt) << "its tracks are not its own life";
  EXPECT_EQ(life_of_camera(log(), cam1_), std::nullopt);
}

TEST_F(CameraLife, ARestartLeavesTheMap) {
  camera(0, EventKind::kCameraJoined, 0, Why::kHello);
  camera(1, EventKind::kCameraPlaced, 2, Why::kStartedAlone, {34, 0});
  camera(2, EventKind::kCameraLost, 2, Why::kNoPose, {30, 4});
  camera(3, EventKind::kCameraJoined, 2, Why::kRestarted);
  map(4, EventKind::kMapMoved, 2, Why::kLoopClosed, {1.1, 0});
  EXPECT_THAT(text(), HasSubstr("3.000 s  It joined because its agent was started anew.\n"));
  EXPECT_THAT(text(), Not(HasSubstr("4.000 s"))) << "the map is no longer its own";
  EXPECT_EQ(state(2.5), "At 2.500 s camera cam0 was without a pose, in map 2.");
  EXPECT_EQ(state(3.5), "At 3.500 s camera cam0 was in no map.");
}

TEST_F(CameraLife, LostAndFoundAtTwoInstantsAreTwoSentences) {
  camera(1, EventKind::kCameraPlaced, 2, Why::kStartedAlone, {34, 0});
  camera(2, EventKind::kCameraLost, 2, Why::kNoPose, {30, 4});
  camera(2.1, EventKind::kCameraFound, 2, Why::kPoseAgain, {1, 0});
  EXPECT_THAT(text(), HasSubstr("2.000 s  It lost its pose"));
  EXPECT_THAT(text(), HasSubstr("2.100 s  It had a pose again"));
  EXPECT_THAT(text(), Not(HasSubstr("All points of its group")));
}

TEST_F(CameraLife, FindingsAboutItsImagesAreTold) {
  camera(1, EventKind::kCameraMisdated, 2, Why::kMovesAtOtherTimes, {0.25, 1});
  camera(2, EventKind::kCameraLens, 2, Why::kLensFound, {1.05, 3});
  EXPECT_THAT(text(), HasSubstr("1.000 s  Its images are dated wrongly, "));
  EXPECT_THAT(text(), HasSubstr("0.25"));
  EXPECT_THAT(text(), HasSubstr("2.000 s  Its lens was corrected "));
  EXPECT_THAT(text(), HasSubstr("1.05"));
}

TEST_F(CameraLife, WhatComesToItsMapIsTold) {
  camera(1, EventKind::kCameraPlaced, 2, Why::kStartedAlone, {34, 0});
  map(2, EventKind::kMapStarted, 3, Why::kStartedAlone, {12, 0});
  map(3, EventKind::kMapMoved, 3, Why::kLoopClosed, {1.1, 0});
  map(4, EventKind::kMapMerged, 2, Why::kMapsMet, {0.5, 0}).from = MapId(3);
  EXPECT_THAT(text(), Not(HasSubstr("2.000 s")));
  EXPECT_THAT(text(), Not(HasSubstr("3.000 s")));
  EXPECT_THAT(text(), HasSubstr("4.000 s  Map 3 became part of map 2"));
  EXPECT_EQ(state(5), "At 5.000 s camera cam0 was in map 2.");
}

}  // namespace
}  // namespace coslam::explain::camera_life_test
