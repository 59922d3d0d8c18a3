// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/link/sessions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "common/wire/codec.h"
#include "tests/support/wire_values.h"

namespace coslam::sessions_test {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;

struct Text {
  std::string operator()(const Hello& e) const { return "hello " + std::to_string(e.agent_run.value); }
  std::string operator()(const JoinedFrame& e) const {
    return "frame " + std::to_string(e.frame.frame.value) + (e.patches ? " with patches" : "");
  }
  std::string operator()(const AgentStatus& e) const { return "status at " + std::to_string(e.frames); }
  std::string operator()(const AgentSilent& e) const { return e.agent + " silent"; }
  std::string operator()(const AgentGone& e) const { return e.agent + " gone"; }
};

class SessionsTest : public testing::Test {
 protected:
  void hello(const std::string& agent, std::uint64_t run, Pacing pacing = Pacing::kLive) {
    sessions_.receive(encode(values_.hello(agent, RunId(run), pacing)), 1, now_);
  }
  void join(const std::string& agent, std::uint64_t run, Pacing pacing = Pacing::kLive) {
    hello(agent, run, pacing);
    sessions_.open(RunId(run));
    sessions_.take_events();
  }
  void frame(const std::string& agent, std::uint64_t run, std::uint32_t number, std::uint16_t patches = 0) {
    TrackFrame f = values_.frame(agent, RunId(run), number, 20);
    f.patches_sent = patches;
    sessions_.receive(encode(f, pixel_scale(test::vga_camera())), 100, now_);
  }
  void patches(const std::string& agent, std::uint64_t run, std::uint32_t number) {
    sessions_.receive(encode(PatchReply{agent, RunId(run), FrameId(number), {}}), 1000, now_);
  }
  void status(const std::string& agent, std::uint64_t run, std::uint32_t frames) {
    sessions_.receive(encode(AgentStatus{.agent = agent, .agent_run = RunId(run), .frames = frames}), 10, now_);
  }
  void is(std::uint64_t run, Presence presence) { sessions_.presence(RunId(run), presence); }
  std::vector<std::string> events() {
    std::vector<std::string> all;
    for (const ServerEvent& e : sessions_.take_events()) all.push_back(std::visit(Text(), e));
    return all;
  }

  Instant now_{};
  RejectionCounts rejections_;
  Sessions sessions_{1000ms, rejections_};
  test::WireValues values_{3};
};

TEST_F(SessionsTest, NothingIsDeliveredBeforeTheWayBackIsOpen) {
  hello("a", 1);
  EXPECT_THAT(sessions_.waiting(), ElementsAre(RunId(1)));
  frame("a", 1, 0);
  sessions_.tick(now_);
  EXPECT_THAT(events(), IsEmpty());
  EXPECT_EQ(rejections_[Rejection::kUnknownAgent], 1U);
  for (const std::uint64_t run : {1U, 1U, 2U}) sessions_.open(RunId(run));
  EXPECT_THAT(sessions_.waiting(), IsEmpty());
  frame("a", 1, 1);
  EXPECT_THAT(events(), ElementsAre("hello 1", "frame 1"));
  EXPECT_EQ(rejections_.total(), 1U);
}

TEST_F(SessionsTest, StatusesAheadOfTheirHelloFollowItWhileThereIsRoom) {
  for (std::uint32_t run = 1; run <= idl::MAX_AGENTS + 1; ++run) status("a" + std::to_string(run), run, run);
  status("a2", 2, 22);
  is(1, Presence::kGone);
  status("a66", 66, 66);
  for (const std::uint64_t run : {65U, 66U, 2U, 1U}) {
    hello("a" + std::to_string(run), run);
    sessions_.open(RunId(run));
  }
  EXPECT_THAT(events(), ElementsAre("hello 65", "hello 66", "status at 66", "hello 2", "status at 22", "hello 1"));
}

TEST_F(SessionsTest, AFrameWaitsForItsPatchesOrForTimeToPass) {
  join("a", 1, Pacing::kLockstep);
  join("b", 2);
  frame("a", 1, 0, 3);
  frame("b", 2, 1, 3);
  sessions_.tick(now_ += FrameJoiner::kPatience - 1ms);
  EXPECT_THAT(events(), IsEmpty());
  sessions_.tick(now_ += 1ms);
  patches("a", 1, 0);
  EXPECT_THAT(events(), ElementsAre("frame 1", "frame 0 with patches"));
}

TEST_F(SessionsTest, WhomTheServerRefusesIsNotHeardAnyMore) {
  join("a", 1);
  patches("a", 1, 0);
  frame("a", 1, 1);
  sessions_.refuse(values_.hello("a", RunId(1)), "not in the sequence");
  EXPECT_FALSE(sessions_.knows(RunId(1)));
  EXPECT_EQ(sessions_.late_replies(), 1U) << "also of runs that ended";
  frame("a", 1, 2);
  status("a", 1, 2);
  EXPECT_THAT(events(), ElementsAre("frame 1 with patches"));
  EXPECT_EQ(rejections_[Rejection::kWrongRun], 2U);
}

TEST_F(SessionsTest, OnlyLockstepFramesThatComeAgainAreToAnswerAgain) {
  join("a", 1, Pacing::kLockstep);
  join("b", 2, Pacing::kLive);
  for (int i = 0; i < 2; ++i) {
    frame("a", 1, 7);
    frame("b", 2, 8);
  }
  EXPECT_THAT(events(), ElementsAre("frame 7", "frame 8"));
  EXPECT_EQ(rejections_[Rejection::kDuplicate], 2U);
  EXPECT_THAT(sessions_.take_repeated(), ElementsAre(testing::Pair(RunId(1), FrameId(7))));
  EXPECT_THAT(sessions_.take_repeated(), IsEmpty());
}

TEST_F(SessionsTest, SilenceIsToldOnceUntilASignOfLife) {
  hello("a", 1);
  is(1, Presence::kSilent);
  EXPECT_THAT(events(), IsEmpty()) << "nobody was told of it";
  sessions_.open(RunId(1));
  for (int i = 0; i < 2; ++i) is(1, Presence::kSilent);
  is(1, Presence::kAlive);
  for (int i = 0; i < 2; ++i) is(1, Presence::kSilent);
  status("a", 1, 9);
  is(1, Presence::kSilent);
  EXPECT_THAT(events(), ElementsAre("hello 1", "a silent", "a silent", "status at 9", "a silent"));
}

TEST_F(SessionsTest, AGoneRunLeavesWhatItSentAndComesBackWithoutRepeatingIt) {
  join("a", 1);
  frame("a", 1, 4, 3);
  is(1, Presence::kGone);
  EXPECT_THAT(events(), ElementsAre("frame 4", "a gone")) << "its patches do not come any more";
  EXPECT_TRUE(sessions_.knows(RunId(1)));
  EXPECT_THAT(sessions_.waiting(), IsEmpty());
  frame("a", 1, 5);
  EXPECT_THAT(sessions_.waiting(), ElementsAre(RunId(1))) << "a sample is a sign of life";
  sessions_.open(RunId(1));
  frame("a", 1, 4);
  frame("a", 1, 5);
  EXPECT_THAT(events(), ElementsAre("hello 1", "frame 5"));
  EXPECT_EQ(rejections_[Rejection::kDuplicate], 1U);
}

TEST_F(SessionsTest, AGoneLockstepRunLeavesWhatItSentToo) {
  join("a", 1, Pacing::kLockstep);
  frame("a", 1, 4, 3);
  EXPECT_THAT(events(), IsEmpty()) << "it waits for its patches, however long";
  is(1, Presence::kGone);
  EXPECT_THAT(events(), ElementsAre("frame 4", "a gone"));
}

TEST_F(SessionsTest, ARestartEndsTheRunBefore) {
  join("a", 1);
  hello("a", 2);
  EXPECT_THAT(sessions_.waiting(), IsEmpty()) << "the first may be alive";
  is(1, Presence::kSilent);
  EXPECT_FALSE(sessions_.knows(RunId(1)));
  EXPECT_THAT(sessions_.waiting(), ElementsAre(RunId(2)));
  sessions_.open(RunId(2));
  frame("a", 1, 1);
  frame("a", 2, 0);
  EXPECT_THAT(events(), ElementsAre("a silent", "hello 2", "frame 0"));
  EXPECT_EQ(rejections_[Rejection::kWrongRun], 1U);
  hello("a", 3);
  sessions_.tick(now_ + 1000ms);
  EXPECT_EQ(sessions_.refused().back().agent_run, RunId(3)) << "its time is up";
}

TEST_F(SessionsTest, FramesAreDecodedAgainstThoseOfTheirOwnRun) {
  const double scale = pixel_scale(test::vga_camera());
  TrackEncoder encoder(scale);
  const auto message = [&](std::uint32_t number, std::optional<FrameId> acknowledged) {
    return encoder.encode(values_.frame("a", RunId(1), number, 20), acknowledged);
  };
  join("a", 1);
  join("b", 2);
  sessions_.receive(message(0, {}), 1, now_);
  frame("b", 2, 5);
  sessions_.receive(message(1, FrameId(0)), 1, now_);
  is(1, Presence::kGone);
  sessions_.receive(message(2, FrameId(1)), 1, now_);  // a sign of life; it is not open yet
  sessions_.open(RunId(1));
  sessions_.receive(message(3, FrameId(1)), 1, now_);
  EXPECT_THAT(events(), ElementsAre("frame 0", "frame 5", "frame 1", "a gone", "hello 1", "frame 3"));
  sessions_.receive(message(4, FrameId(2)), 1, now_);
  EXPECT_THAT(events(), IsEmpty());
  EXPECT_EQ(rejections_[Rejection::kMissingReference], 1U) << "it was not open when frame 2 came";
  sessions_.receive(message(5, FrameId(3)), 1, now_);
  EXPECT_THAT(events(), ElementsAre("frame 5"));
  EXPECT_EQ(sessions_.bytes("a").up, 1U + 5) << "what is of no use was sent all the same";
}

TEST_F(SessionsTest, BytesAreThoseOfAdmittedRuns) {
  join("a", 1);
  hello("b", 2);
  frame("a", 1, 0);
  frame("a", 1, 0);  // its bytes came all the same
  patches("a", 1, 0);
  frame("b", 2, 0);  // not open yet
  frame("a", 9, 0);
  EXPECT_EQ(sessions_.bytes("a").up, 1U + 100 + 100 + 1000);
  EXPECT_EQ(sessions_.bytes("b").up, 1U);
  sessions_.count_down(RunId(1), 5);
  sessions_.count_down_all(20);
  EXPECT_EQ(sessions_.bytes("a").down, 25U);
  EXPECT_EQ(sessions_.bytes("b").down, 0U) << "nothing reaches it yet";
}

TEST_F(SessionsTest, AThumbnailIsTakenFromTheRunThatWasAsked) {
  join("a", 1);
  EXPECT_EQ(sessions_.look("b", now_), std::nullopt) << "there is no such agent";
  EXPECT_EQ(sessions_.look("a", now_), RunId(1));
  sessions_.receive(encode(values_.thumbnail("a", RunId(2))), 100, now_);
  EXPECT_FALSE(sessions_.thumbnail("a", now_)) << "of a run that is not admitted";
  sessions_.receive(encode(values_.thumbnail("a", RunId(1))), 100, now_);
  EXPECT_TRUE(sessions_.thumbnail("a", now_));
  EXPECT_THAT(events(), IsEmpty()) << "the map does not hear of it";
  is(1, Presence::kGone);
  EXPECT_EQ(sessions_.look("a", now_ + 1s), std::nullopt);
}

}  // namespace
}  // namespace coslam::sessions_test
