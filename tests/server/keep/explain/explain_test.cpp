// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <string>

#include "common/base/error.h"
#include "common/dataset/event_file.h"
#include "server/keep/explain/answer.h"
#include "server/keep/explain/life.h"
#include "tests/server/keep/explain/story.h"
#include "tests/support/temp_folder.h"

namespace coslam::explain::explain_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

using PointStory = Story;
using TrackStory = Story;
using CameraStory = Story;

TEST_F(PointStory, FromItsMakingToItsRemoval) {
  made(1, 7, PointPhase::kTrial, Why::kOneCamerasMotion, {12, 0.03125});
  track(1, EventKind::kTrackBound, cam0_, 45, 7, Why::kMadeFromIt);
  became(1.5, 7, PointPhase::kStatic, Why::kStoodTheTrial, {6, 0});
  track(2, EventKind::kTrackBound, cam1_, 3, 7, Why::kRegistered, {1.5, 0.875});
  track(3, EventKind::kTrackUnbound, cam1_, 3, 7, Why::kOutsideGate, {5, 4.25});
  track(4, EventKind::kTrackUnbound, cam0_, 45, 7, Why::kPointGone);
  removed(4, 7, Why::kUndetermined, {3, 2});
  EXPECT_EQ(
      point(7),
      "     1.000 s  It was made, on trial, of cam0/45, from one camera's motion: 12 views, standard deviation "
      "0.0312 of its distance.\n"
      "     1.500 s  It became static after 6 views inside the gate.\n"
      "     2.000 s  cam1/3 was bound to it because it is where the point should appear (1.5 sigma off) and looks "
      "like it (correlation 0.875).\n"
      "     3.000 s  cam1/3 was unbound because it was outside the gate 5 times in succession, the last time by "
      "4.25 sigma.\n"
      "     4.000 s  It was removed because its views do not determine it: standard deviation 3 at a distance of "
      "2.\n");
  EXPECT_FALSE(life_of_point(log(), PointId(7))->alive);
  EXPECT_EQ(life_of_point(log(), PointId(8)), std::nullopt);
}

TEST_F(PointStory, WhatItWasAtAnInstant) {
  made(1, 7, PointPhase::kTrial, Why::kOneCamerasMotion, {12, 0.03});
  track(1, EventKind::kTrackBound, cam0_, 45, 7, Why::kMadeFromIt);
  became(2, 7, PointPhase::kMoving, Why::kSeenElsewhere, {2, 0});
  track(3, EventKind::kTrackEnded, cam0_, 45, 7, Why::kImageEnded, {21, 0});
  removed(4, 7, Why::kOutOfSight, {31, 30});
  EXPECT_THAT(point_at(7, 0.5), HasSubstr("At 0.500 s point 7 was not there yet.\n     1.000 s  It was made"));
  EXPECT_THAT(point_at(7, 1.5), HasSubstr("was on trial, in map 1, followed by cam0/45.\n     1.000 s  It was made"));
  EXPECT_EQ(point_at(7, 2.5),
            "At 2.500 s point 7 was moving, in map 1, followed by cam0/45.\n"
            "     1.000 s  cam0/45 was bound to it because the point was made from it.\n"
            "     2.000 s  It became moving because several of its 2 tracks were outside the gate, and all agree on "
            "another place.\n");
  EXPECT_THAT(point_at(7, 3), HasSubstr("was moving, in map 1.\n"));
  EXPECT_EQ(point_at(7, 100),
            "At 100.000 s point 7 was no longer in the map.\n"
            "     4.000 s  It was removed because fewer than two cameras saw it for 31 frame sets (limit 30).\n");
}

TEST_F(PointStory, GoesOnAsThePointThatItBecamePartOf) {
  made(1, 3, PointPhase::kStatic, Why::kTwoCamerasNow, {2, 0.01});
  track(1, EventKind::kTrackBound, cam0_, 1, 3, Why::kMadeFromIt);
  made(2, 4, PointPhase::kTrial, Why::kTwoCamerasNow, {2, 0.01});
  track(2, EventKind::kTrackBound, cam1_, 2, 4, Why::kMadeFromIt);
  made(2, 5, PointPhase::kTrial, Why::kTwoCamerasNow, {2, 0.01});
  fused(3, 4, 5);
  fused(4, 3, 4);
  became(5, 3, PointPhase::kMoving, Why::kSeenElsewhere, {2, 0});
  const std::string chain = point(5);
  EXPECT_THAT(chain, HasSubstr("3.000 s  It became part of point 4 because both are one corner: 0.5 sigma apart in the "
                               "image, correlation 0.925; what follows is the life of point 4.\n"
                               "     4.000 s  It became part of point 3 "));
  EXPECT_THAT(chain, HasSubstr("5.000 s  It became moving"));
  EXPECT_THAT(chain, Not(HasSubstr("1.000 s"))) << "the life of point 3 before is not its own";
  const auto life = life_of_point(log(), PointId(5));
  EXPECT_TRUE(life->alive);
  EXPECT_EQ(life->last, PointId(3));
  EXPECT_THAT(point(3), HasSubstr("4.000 s  Point 4, made at 2.000 s, became part of it because both are one corner"));
  // What point 3 was before counts from the fusion on, and not before.
  EXPECT_THAT(point_at(5, 3.5), HasSubstr("was on trial, in map 1, followed by cam1/2.\n"));
  EXPECT_THAT(point_at(5, 4.5), HasSubstr("was static, in map 1, followed by cam0/1 and cam1/2.\n"));
  EXPECT_THAT(point_at(5, 5), HasSubstr("was moving"));
}

TEST_F(PointStory, RepeatedMissesAreOneSentence) {
  made(1, 7, PointPhase::kStatic, Why::kTwoCamerasNow, {2, 0.01});
  for (int i = 0; i < 4; ++i) {
    track(2 + i, EventKind::kTrackMissed, cam0_, 1, 7, Why::kOutsideGate, {1, 2.5 + i});
    if (i == 1) track(3, EventKind::kTrackMissed, cam1_, 2, 7, Why::kBehindCamera, {1, 0});
  }
  track(6, EventKind::kTrackUnbound, cam0_, 1, 7, Why::kOutsideGate, {3, 4});
  track(7, EventKind::kTrackMissed, cam1_, 2, 7, Why::kOutsideGate, {1, 3});
  const std::string text = point(7);
  EXPECT_THAT(text,
              HasSubstr("     2.000 s  cam0/1 missed the gate by 2.5 sigma, the first of 4 times until 5.000 s, by "
                        "up to 5.5 sigma.\n     3.000 s  cam1/2 missed the gate: behind its camera.\n"));
  EXPECT_THAT(text, HasSubstr("     7.000 s  cam1/2 missed the gate by 3 sigma.\n"));
}

TEST_F(PointStory, FollowsItsMap) {
  made(1, 7, PointPhase::kStatic, Why::kStartOfMap, {20, 0}, 3);
  map(2, EventKind::kMapMoved, 1, Why::kLoopClosed, {1.1, 0});
  map(3, EventKind::kMapMerged, 1, Why::kMapsMet, {0.5, 0}).from = MapId(3);
  map(4, EventKind::kMapMoved, 1, Why::kAdjusted, {12, 300});
  map(5, EventKind::kMapMoved, 1, Why::kLoopClosed, {1.2, 0});
  EXPECT_EQ(
      point(7),
      "     1.000 s  It was made, static, at the start of its map, seen by 20 tracks.\n"
      "     3.000 s  Map 3 became part of map 1 because a camera of one recognised a place of the other: scale "
      "0.5.\n"
      "     5.000 s  Its map 1 was moved because a place was recognised that the map had elsewhere: scale 1.2.\n");
  EXPECT_THAT(point_at(7, 2), HasSubstr("static, in map 3"));
  EXPECT_THAT(point_at(7, 3), HasSubstr("static, in map 1"));
}

TEST_F(TrackStory, ItsStates) {
  const auto to = [](Event& e, TrackMotion motion) { e.to = static_cast<std::uint8_t>(motion); };
  camera(0.5, EventKind::kCameraPlaced, 1, Why::kStartedAlone, {5, 0});
  to(track(1, EventKind::kTrackBecame, cam0_, 9, 0, Why::kNoStaticPlace, {3, 1}), TrackMotion::kDoubtful);
  to(track(2, EventKind::kTrackBecame, cam0_, 9, 0, Why::kStaticPlace, {1, 5}), TrackMotion::kResting);
  made(3, 7, PointPhase::kStatic, Why::kTwoCamerasNow, {2, 0.01});
  track(3, EventKind::kTrackBound, cam0_, 9, 7, Why::kMadeFromIt);
  made(3, 6, PointPhase::kStatic, Why::kTwoCamerasNow, {2, 0.01});
  fused(3.5, 6, 7);
  became(4, 6, PointPhase::kMoving, Why::kSeenElsewhere, {2, 0});
  to(track(5, EventKind::kTrackUnbound, cam0_, 9, 6, Why::kStandsStill, {12, 0}), TrackMotion::kMoving);
  to(track(6, EventKind::kTrackBecame, cam0_, 9, 0, Why::kStaticPlace, {1, 5}), TrackMotion::kResting);
  track(7, EventKind::kTrackEnded, cam0_, 9, 0, Why::kImageEnded, {66, 0});
  EXPECT_EQ(
      track_of(cam0_, 9),
      "     0.500 s  Its camera began to follow it.\n"
      "     1.000 s  It became doubtful because no static place explains it or its neighbours: of the tracks around it "
      "3 move "
      "and 1 rest.\n"
      "     2.000 s  It counts as resting again because a static place explains it or its neighbours better than "
      "before: "
      "of the tracks around it 1 move and 5 rest.\n"
      "     3.000 s  It was bound to point 7 because the point was made from it.\n"
      "     3.500 s  Its point 7 became part of point 6 because both are one corner: 0.5 sigma apart in the image, "
      "correlation 0.925.\n"
      "     4.000 s  Its point 6 became moving because several of its 2 tracks were outside the gate, and all agree on "
      "another place.\n"
      "     5.000 s  It was unbound from point 6 because it stood still for 12 frames, with no other camera to tell "
      "how far away.\n"
      "     6.000 s  It counts as resting again because a static place explains it or its neighbours better than "
      "before: "
      "of the tracks around it 1 move and 5 rest.\n"
      "     7.000 s  It ended because its camera follows it no longer, after 66 frame sets.\n");
  const auto state = [&](double t_s) {
    const std::string text = track_at(cam0_, 9, t_s);
    return text.substr(0, text.find('\n'));
  };
  EXPECT_THAT(state(0.2), HasSubstr("not there yet"));
  EXPECT_THAT(state(0.7), HasSubstr("was unmapped."));
  EXPECT_THAT(state(1.5), HasSubstr("was doubtful."));
  EXPECT_THAT(state(3.2), HasSubstr("was mapped, as point 7."));
  EXPECT_THAT(state(3.7), HasSubstr("was mapped, as point 6."));
  EXPECT_THAT(state(4.5), HasSubstr("was moving, with point 6."));
  EXPECT_THAT(state(5.5), HasSubstr("was moving."));
  EXPECT_THAT(state(8), HasSubstr("was no longer followed."));
}

TEST_F(TrackStory, NumbersAreUsedAgainAfterARestart) {
  track(1, EventKind::kTrackBound, cam0_, 9, 7, Why::kRegistered, {1, 0.9});
  track(2, EventKind::kTrackEnded, cam0_, 9, 7, Why::kRestarted, {40, 0});
  track(3, EventKind::kTrackBound, cam0_, 9, 8, Why::kRegistered, {1, 0.9});
  EXPECT_THAT(track_of(cam0_, 9), HasSubstr("2.000 s  It ended because its agent was started anew.\n"
                                            "     3.000 s  Another track has its number.\n"
                                            "     3.000 s  It was bound to point 8"));
}

TEST_F(CameraStory, ItsPlaceAndPose) {
  camera(0, EventKind::kCameraJoined, 0, Why::kHello);
  map(1, EventKind::kMapStarted, 2, Why::kStartedAlone, {34, 0});
  camera(1, EventKind::kCameraPlaced, 2, Why::kStartedAlone, {34, 0});
  for (int i = 0; i < 3; ++i) map(2 + 0.1 * i, EventKind::kMapMoved, 2, Why::kAdjusted, {10.0 + i, 800});
  for (int i = 0; i < 2; ++i) {
    camera(3 + 0.1 * i, EventKind::kCameraLost, 2, Why::kNoPose, {30, 4});
    camera(3 + 0.1 * i, EventKind::kCameraFound, 2, Why::kPoseAgain, {1, 0});
  }
  camera(4, EventKind::kCameraLost, 2, Why::kNoPose, {20, 3});
  camera(5, EventKind::kCameraFound, 2, Why::kPoseAgain, {10, 0});
  map(6, EventKind::kMapMerged, 1, Why::kMapsMet, {0.5, 0}).from = MapId(2);
  camera(7, EventKind::kCameraLost, 1, Why::kNoPose, {20, 3});
  camera(8, EventKind::kCameraLeft, 1, Why::kLostTooLong, {61, 0});
  const auto life = life_of_camera(log(), cam0_);
  ASSERT_TRUE(life);
  EXPECT_EQ(
      life_text(log(), *life),
      "     0.000 s  It joined because its agent said hello.\n"
      "     1.000 s  It was put into map 2 from its own motion over 34 frame sets.\n"
      "     2.000 s  Its map 2 was changed by a bundle adjustment of 10 poses and 800 points, the first of 3 times "
      "until 2.200 s.\n"
      "     3.000 s  All points of its group, also those that move, gave it the pose that its own did not because "
      "too few of the 30 known points that it sees agree with any pose (4 do), the first of 2 times until 3.100 "
      "s.\n"
      "     4.000 s  It lost its pose because too few of the 20 known points that it sees agree with any pose (3 "
      "do).\n"
      "     5.000 s  It had a pose again after 10 frame sets without one.\n"
      "     6.000 s  Map 2 became part of map 1 because a camera of one recognised a place of the other: scale "
      "0.5.\n"
      "     7.000 s  It lost its pose because too few of the 20 known points that it sees agree with any pose (3 "
      "do).\n"
      "     8.000 s  It left map 1 because it had no pose for 61 frame sets.\n");
  const auto state = [&](double t_s) {
    const std::string text = told_at(log(), *life, to_ns(t_s));
    return text.substr(0, text.find('\n'));
  };
  EXPECT_EQ(state(0.5), "At 0.500 s camera cam0 was in no map.");
  EXPECT_EQ(state(4.5), "At 4.500 s camera cam0 was without a pose, in map 2.");
  EXPECT_EQ(state(5.5), "At 5.500 s camera cam0 was in map 2.");
  EXPECT_EQ(state(6.5), "At 6.500 s camera cam0 was in map 1.");
}

class Answers : public ::testing::Test {
 protected:
  static constexpr const char* kHeader = "t_s,set,kind,why,map,from,point,other,camera,track,to,a,b\n";
  static constexpr const char* kEvents =
      "1760000000.0,0,camera_joined,hello,,,,,left,,,,\n"
      "1760000001.5,9,point_made,two_cameras_now,1,,3,,,,static,,0.01\n"
      "1760000001.5,9,track_bound,made_from_it,1,,3,,left,17,resting,,\n";
  static constexpr const char* kEnd = "1760000009.0,90,end,run_is_over,,,,,,,,,\n";

  void write(const std::string& text) { temp_.write("events.csv", kHeader + text); }
  Answer ask(const std::string& kind, const std::string& id, std::optional<double> at_s = std::nullopt) {
    return answer(result_, {kind, id, at_s});
  }
  template <class E>
  std::string refusal(const std::string& kind, const std::string& id) {
    return test::error_of<E>([&] { ask(kind, id); });
  }

  test::TempFolder temp_;
  ResultFolder result_{temp_.path()};
};

TEST_F(Answers, EndWithWhatTheResultHas) {
  write(std::string(kEvents) + kEnd);
  PointWriter points(result_.points());
  points.write({.id = PointId(3),
                .position = {1, -2, 0.125},
                .covariance = 3 * Eigen::Matrix3d::Identity(),
                .first_ns = 1'760'000'001'500'000'000,
                .last_ns = 1'760'000'008'000'000'000,
                .views = 12});
  points.close();
  DynamicWriter dynamic(result_.dynamic());
  for (const TimeNs t_ns : {1'760'000'002'000'000'000, 1'760'000'003'000'000'000}) {
    dynamic.write({t_ns, PointId(3), {1, 2, 3}, Eigen::Matrix3d::Identity() / 3, 2});
  }
  dynamic.close();
  const Answer a = ask("point", "3");
  EXPECT_EQ(a.caution, "");
  EXPECT_EQ(a.text,
            "point 3, in seconds of the run\n"
            "     1.500 s  It was made, static, of left/17, from two cameras at once: standard deviation 0.01 of its "
            "distance.\n"
            "points.csv has point 3: static, at (1, -2, 0.125), standard deviation 3, 12 views from 1.500 s to 8.000 "
            "s.\n"
            "dynamic.csv has its path, 2 places from 2.000 s to 3.000 s, the last one at (1, 2, 3), standard deviation "
            "1, 2 views.\n");
  EXPECT_THAT(ask("track", "left/17", 2).text, HasSubstr("At 2.000 s track left/17 was mapped, as point 3.\n"));
  EXPECT_THAT(ask("track", "left/17", 99).text,
              StartsWith("The run ended at 9.000 s.\nAt 9.000 s track left/17 was mapped, as point 3.\n"));
  EXPECT_THAT(ask("camera", "left").text, HasSubstr("0.000 s  It joined because its agent said hello.\n"));
}

TEST_F(Answers, SayWhatTheFileDoesNotHold) {
  EXPECT_THAT(refusal<UserError>("point", "3"), HasSubstr("events.csv: there is none"));
  write(std::string(kEvents) + "1760000009.0,90,end,file_is_full,,,,,,,,,\n");
  EXPECT_THAT(ask("point", "3").caution, HasSubstr("reached its bound (server.events.most_mb) at 9.000 s"));
  EXPECT_THAT(refusal<UserError>("point", "4"), HasSubstr("point 4; events.csv reached its bound"))
      << "it may come later";
  write(kEvents);
  EXPECT_THAT(ask("point", "3").caution, HasSubstr("has no end: the run goes on, or was cut off at 1.500 s"));
  write(std::string(kEvents) + "1760000002.0,12,poi");
  EXPECT_THAT(ask("point", "3").text, HasSubstr("It was made"));
  EXPECT_THAT(ask("point", "3").caution, HasSubstr("cut off at 1.500 s"));
  write(std::string(kEvents) + "1760000002.0,12,point_removed,a_whim,1,,3,,,,static,,\n" + kEnd);
  EXPECT_THAT(refusal<UserError>("point", "3"), HasSubstr("events.csv:5: not a line"));
}

TEST_F(Answers, RefuseWhatNobodyKnows) {
  write(std::string(kEvents) + kEnd);
  EXPECT_EQ(refusal<UserError>("point", "4"), "events.csv does not speak of point 4: there was none");
  EXPECT_THAT(refusal<UserError>("track", "left/18"), HasSubstr("does not speak of track left/18"));
  EXPECT_EQ(refusal<UserError>("track", "right/17"), "the run had no camera right; it had left");
  EXPECT_EQ(refusal<UserError>("camera", "right"), "the run had no camera right; it had left");
  EXPECT_THAT(refusal<UsageError>("point", "x"), HasSubstr("`x` is no number of a point"));
  EXPECT_THAT(refusal<UsageError>("track", "17"), HasSubstr("AGENT/TRACK is expected"));
}

}  // namespace
}  // namespace coslam::explain::explain_test
