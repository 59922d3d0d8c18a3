// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/app/roster.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace coslam::roster_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

Hello hello(const std::string& name, std::uint64_t run, Pacing pacing = Pacing::kLive) {
  Hello h;
  h.agent = name;
  h.agent_run = RunId(run);
  h.rate_hz = 30;
  h.pacing = pacing;
  return h;
}

TEST(Roster, ThoseThatAreExpectedComeInTheirOrder) {
  Roster roster({"b", "a"});
  EXPECT_THAT(roster.why_not(hello("c", 1)).value_or(""), HasSubstr("not one that this server waits for"));
  roster.wait(hello("a", 1));
  EXPECT_THAT(roster.take_complete(), IsEmpty());
  roster.wait(hello("b", 2));
  const std::vector<Hello> all = roster.take_complete();
  ASSERT_THAT(all, SizeIs(2));
  EXPECT_EQ(all[0].agent, "b");
}

TEST(Roster, OneThatHasGoneIsWaitedForAgain) {
  Roster roster({"a", "b"});
  roster.wait(hello("a", 1));
  roster.stop_waiting("a");
  roster.wait(hello("b", 2));
  EXPECT_THAT(roster.take_complete(), IsEmpty());
}

TEST(Roster, AnAgentIsFoundByItsPresentRunAlone) {
  Roster roster({});
  roster.admit(hello("a", 1), CameraId(0), false);
  EXPECT_NE(roster.find("a", RunId(1)), nullptr);
  roster.admit(hello("a", 2), CameraId(0), false);
  EXPECT_EQ(roster.find("a", RunId(1)), nullptr);
  EXPECT_NE(roster.find("a", RunId(2)), nullptr);
  EXPECT_EQ(roster.find("b", RunId(1)), nullptr);
}

TEST(Roster, LockStepAndRealTimeDoNotMix) {
  Roster roster({});
  roster.admit(hello("a", 1, Pacing::kLockstep), CameraId(0), false);
  EXPECT_TRUE(roster.why_not(hello("b", 2, Pacing::kLive)));
  EXPECT_FALSE(roster.why_not(hello("b", 2, Pacing::kLockstep)));
  roster.find("a", RunId(1))->ended = true;
  EXPECT_FALSE(roster.why_not(hello("b", 2, Pacing::kLive))) << "nobody is here any more who would be waited for";
}

TEST(Roster, ThoseThatHaveEndedAreNamedLast) {
  Roster roster({});
  for (const char* name : {"a", "b", "c"}) roster.admit(hello(name, 1), CameraId(0), false);
  roster.at("a").ended = true;
  EXPECT_THAT(roster.names(), ElementsAre("b", "c", "a"));
  EXPECT_FALSE(roster.all_ended());
}

TEST(Roster, OneThatJoinsLateIsToldHowManyImagesItMissed) {
  Roster roster({});
  roster.admit(hello("a", 1), CameraId(0), false);
  Roster::Agent& agent = roster.at("a");
  TrackFrame frame;
  frame.frame = FrameId(60);
  frame.capture_ns = 2'000'000'000;
  Roster::note_missed(frame, false, {}, &agent);
  EXPECT_EQ(agent.missed, 60U);
  EXPECT_THAT(Roster::problem_of("a", agent, agent.images.so_far()), HasSubstr("60"));
  frame.capture_ns = kFirstDate_ns;
  roster.admit(hello("b", 1), CameraId(1), false);
  Roster::note_missed(frame, false, {}, &roster.at("b"));
  EXPECT_EQ(roster.at("b").missed, 0U) << "a camera plays no recording";
}

}  // namespace
}  // namespace coslam::roster_test
