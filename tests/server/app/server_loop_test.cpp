// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/app/server_loop.h"

#include <gmock/gmock.h>

#include "common/base/error.h"
#include "deploy/coslam/run/inline_link.h"
#include "tests/support/wire_values.h"

namespace coslam::server_loop_test {
namespace {

using namespace std::chrono_literals;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::SizeIs;

const RunId kServer(1);

// A server without a map to speak of, and agents that come and go.
class ServerLoopTest : public ::testing::Test {
 protected:
  std::unique_ptr<AgentLink> join(const std::string& name, Pacing pacing = Pacing::kLive) {
    auto agent = link_.connect(values_.hello(name, RunId(++last_run_), pacing));
    EXPECT_TRUE(loop_.poll(0ms));
    return agent;
  }
  void come_and_go(std::size_t agents) {
    for (std::size_t i = 0; i < agents; ++i) join("cam" + std::to_string(i));
  }

  test::WireValues values_{1};
  std::uint64_t last_run_ = kServer.value;
  InlineLink link_{kServer};
  ServerLoop loop_{link_.server(), kServer, {.refine_in_thread = false}};
};

TEST_F(ServerLoopTest, OutlivesMoreAgentsThanItsStatusCanName) {
  come_and_go(100);
  const auto here = join("here");
  loop_.finish({});  // with a last status
  const auto status = here->server_status();
  ASSERT_TRUE(status && status->stopping);
  EXPECT_THAT(status->agents, SizeIs(64));
  EXPECT_EQ(status->agents.front(), "here") << "those that left make room";
  EXPECT_THAT(loop_.report()["agents"], SizeIs(101)) << "the report has them all";
}

TEST_F(ServerLoopTest, TurnsAwayWhomItHasNoRoomFor) {
  come_and_go(Roster::kMostAgents);
  const auto late = join("late");
  EXPECT_THAT(refusal_of(*late->server_status(), RunId(last_run_)).value_or(""), HasSubstr("1000 agents"));
  const auto known = join("cam7");
  EXPECT_EQ(refusal_of(*known->server_status(), RunId(last_run_)), std::nullopt) << "its camera is there already";
  loop_.finish({});
  EXPECT_THAT(known->server_status()->agents, Contains("cam7"));
}

// It would make all others wait for it.
TEST_F(ServerLoopTest, TurnsAwayLockStepAmongLiveAgents) {
  const auto live = join("live");
  const auto replay = join("replay", Pacing::kLockstep);
  EXPECT_THAT(refusal_of(*replay->server_status(), RunId(last_run_)).value_or(""), HasSubstr("lock-step"));
  AgentStatus ended = values_.agent_status("live", RunId(last_run_ - 1), AgentState::kFinished);
  live->send(ended);
  EXPECT_TRUE(loop_.poll(0ms));
  const auto later = join("replay", Pacing::kLockstep);
  EXPECT_EQ(refusal_of(*later->server_status(), RunId(last_run_)), std::nullopt);
}

TEST_F(ServerLoopTest, TellsAnAgentAtOnceThatItIsIn) {
  EXPECT_THAT(join("cam0")->server_status()->agents, Contains("cam0")) << "a replay begins then";
}

// One may be lost: an agent tells what its clock is off by from the one that took least.
TEST_F(ServerLoopTest, SaysAgainAndAgainWhenPlayStarts) {
  TimeNs now_ns = to_ns(1000.0);
  const auto now = [&] { return now_ns; };
  ServerLoopConfig config{.refine_in_thread = false};
  config.expected_agents = {"cam0"};
  config.clock = {now, now};
  ServerLoop loop(link_.server(), kServer, config);
  const auto agent = link_.connect(values_.hello("cam0", RunId(2), Pacing::kLive));
  const auto words_within = [&](double s) {
    int words = 0;
    for (const TimeNs end_ns = now_ns + to_ns(s); now_ns < end_ns; now_ns += to_ns(0.02)) {
      EXPECT_TRUE(loop.poll(0ms));
      const auto status = agent->wait_server_status(0ms);
      if (status && status->started) ++words;
    }
    return words;
  };
  EXPECT_GE(words_within(0.3), 3) << "before it starts";
  words_within(2);
  EXPECT_LE(words_within(3), 3) << "in the run";
}

TEST_F(ServerLoopTest, ReportsWhatAnAgentSaysOfItself) {
  const auto agent = join("cam0");
  AgentStatus status = values_.agent_status("cam0", RunId(last_run_), AgentState::kFinished);
  status.frames = 70;
  status.dropped = 7;
  status.left_out = 0;
  status.report_json = R"({"frames":77,"ms":{"track":{"p50":1.5}}})";
  agent->send(status);
  EXPECT_TRUE(loop_.poll(0ms));
  loop_.finish({{"server", "as it was"}});
  const auto& report = loop_.report();
  EXPECT_EQ(report["frames"], 77);
  EXPECT_EQ(report["dropped"], 7);
  EXPECT_EQ(report["agents"]["cam0"]["images"]["lost"], 70) << "none of those that it sent arrived";
  EXPECT_EQ(report["agents"]["cam0"]["dropped"], 7);
  EXPECT_EQ(report["agents"]["cam0"]["frames"], 77);
  EXPECT_EQ(report["agents"]["cam0"]["ms"]["track"]["p50"], 1.5);
  EXPECT_GT(report["agents"]["cam0"]["bytes_up"], 200);
  EXPECT_EQ(report["configuration"]["server"], "as it was");
  for (const char* part : {"version", "frame_sets", "late_frames", "overflowed_frames", "link", "server", "rejected"})
    EXPECT_TRUE(report.contains(part)) << part;
}

TEST_F(ServerLoopTest, WhereARunEndedIsAPlaceToo) {
  const auto agent = join("cam0");
  TrackFrame frame = values_.frame("cam0", RunId(last_run_), 0, 20);
  frame.capture_ns = 0;
  agent->send(frame, {}, {});
  EXPECT_TRUE(loop_.poll(0ms));
  const std::size_t before = loop_.map_server().memory()["places"];
  AgentStatus status = values_.agent_status("cam0", RunId(last_run_), AgentState::kFinished);
  status.last_image = values_.descriptors(frame, 20);
  agent->send(status);
  EXPECT_TRUE(loop_.poll(0ms));
  loop_.finish({});
  EXPECT_GT(loop_.map_server().memory()["places"], before + 20 * kDescriptorBytes);
}

class PlayedByHand : public ServerLoopTest {
 protected:
  PlayedByHand() : by_hand_(link_.server(), kServer, config()) {}
  ServerLoopConfig config() {
    const auto now = [this] { return now_ns_; };
    ServerLoopConfig of{.refine_in_thread = false};
    of.clock = {now, now};
    return of;
  }
  std::unique_ptr<AgentLink> connect(const std::string& name) {
    auto agent = link_.connect(values_.hello(name, RunId(++last_run_), Pacing::kLockstep));
    EXPECT_TRUE(by_hand_.poll(0ms));
    return agent;
  }
  void pass(double s) {
    now_ns_ += to_ns(s);
    EXPECT_TRUE(by_hand_.poll(0ms));
  }
  // All of a recording, as its last word says too.
  void play(AgentLink& agent, const std::string& name, std::uint32_t images) {
    for (std::uint32_t i = 0; i < images; ++i) {
      TrackFrame frame = values_.frame(name, RunId(last_run_), i, 20);
      frame.capture_ns = 33'333'333LL * i;
      agent.send(frame, {}, {});
      pass(0.01);
    }
    AgentStatus status = values_.agent_status(name, RunId(last_run_), AgentState::kFinished);
    status.frames = images;
    status.dropped = status.left_out = 0;
    agent.send(status);
    pass(0);
  }
  TimeNs now_ns_ = to_ns(1000.0);
  ServerLoop by_hand_;
};

TEST_F(PlayedByHand, RecordingsBeginTogetherWhenNobodyHasJoinedForAWhile) {
  const auto first = connect("cam0");
  pass(2);
  EXPECT_FALSE(first->server_status()->started);
  const auto second = connect("cam1");
  pass(2);
  EXPECT_FALSE(first->server_status()->started);
  pass(1.1);
  EXPECT_TRUE(first->server_status()->started);
  EXPECT_TRUE(second->server_status()->started);
  EXPECT_GT(second->server_status()->start_utc_ns, now_ns_);
}

TEST_F(PlayedByHand, ImagesThatWereOverAreSaidToTheirAgent) {
  const auto first = connect("cam0");
  play(*first, "cam0", 31);
  ASSERT_TRUE(first->images());
  EXPECT_EQ(first->images()->images[ImageFate::kWithoutPose], 31U);
  EXPECT_TRUE(first->images()->complete);
  const auto second = connect("cam1");
  play(*second, "cam1", 20);
  const auto images = second->images();
  ASSERT_TRUE(images && images->complete);
  EXPECT_EQ(images->images[ImageFate::kLate], 20U);
  EXPECT_EQ(images->images.captured(), 20U);
  EXPECT_THAT(images->problem, HasSubstr("20 of 20 images of cam1 lie before the 1.0 s"));
  by_hand_.finish({});
  EXPECT_THAT(by_hand_.problem(), HasSubstr("nothing was mapped: cam0 has no pose: "));
  EXPECT_THAT(by_hand_.problem(), HasSubstr("; 20 of 20 images of cam1 lie before"));
}

// Of forty images the agent believes three not, has no time for two, and four are lost on the way; the rest come at
// once, as after a pause of the server, two of them again with a stamp from before.
TEST_F(ServerLoopTest, SaysWhatBecameOfEachImage) {
  const auto agent = join("cam0");
  for (std::uint32_t i = 9; i < 40; ++i) {
    TrackFrame frame = values_.frame("cam0", RunId(last_run_), i, 20);
    frame.capture_ns = 33'333'333LL * (i < 38 ? i : 20);
    agent->send(frame, {}, {});
  }
  AgentStatus status = values_.agent_status("cam0", RunId(last_run_), AgentState::kFinished);
  status.frames = 35;
  status.dropped = 2;
  status.left_out = 3;
  agent->send(status);
  EXPECT_TRUE(loop_.poll(0ms));
  loop_.finish({});
  const auto& images = loop_.report()["agents"]["cam0"]["images"];
  EXPECT_EQ(images["captured"], 40);
  EXPECT_EQ(images["left_out"], 3);
  EXPECT_EQ(images["not_sent"], 2);
  EXPECT_EQ(images["lost"], 4);
  EXPECT_EQ(images["out_of_time"], 2);
  EXPECT_EQ(images["without_pose"], loop_.report()["frame_sets"]);
  EXPECT_EQ(images["set_left_out"], loop_.report()["frame_sets_left_out"]);
  int sum = 0;
  for (const auto& [fate, n] : images.items()) sum += fate == "captured" ? 0 : n.get<int>();
  EXPECT_EQ(sum, 40);
  EXPECT_EQ(loop_.report()["images"], images) << "of all agents";
}

// All come at once, as after a pause of the server.
TEST_F(ServerLoopTest, LeavesOutTheOldestFrameSetsThatItHasNoTimeFor) {
  const auto agent = join("cam0");
  for (std::uint32_t i = 0; i < 40; ++i) {
    TrackFrame frame = values_.frame("cam0", RunId(last_run_), i, 20);
    frame.capture_ns = 33'333'333LL * i;
    agent->send(frame, {}, {});
  }
  EXPECT_TRUE(loop_.poll(0ms));
  loop_.finish({});
  const auto& report = loop_.report();
  EXPECT_EQ(report["frame_sets"].get<int>() + report["frame_sets_left_out"].get<int>(), 40);
  EXPECT_GE(report["frame_sets"], 15) << "half a second is worked off";
  EXPECT_LE(report["frame_sets"], 17);
  EXPECT_EQ(report["frames_out_of_time"], 0);
}

// Whatever its clock says, it cannot make the frames of others late.
TEST_F(ServerLoopTest, AnAgentOfAnotherTimeHurtsNobody) {
  const auto right = join("right");
  const RunId right_run(last_run_);
  const auto wrong = join("wrong");
  for (std::uint32_t i = 0; i < 10; ++i) {
    TrackFrame ahead = values_.frame("wrong", RunId(last_run_), i, 20);
    ahead.capture_ns = 3'600'000'000'000LL + 33'333'333LL * i;
    wrong->send(ahead, {}, {});
    TrackFrame frame = values_.frame("right", right_run, i, 20);
    frame.capture_ns = 33'333'333LL * i;
    right->send(frame, {}, {});
    EXPECT_TRUE(loop_.poll(0ms));
  }
  loop_.finish({});
  EXPECT_EQ(loop_.report()["frames_out_of_time"], 10);
  EXPECT_EQ(loop_.report()["late_frames"], 0);
}

// Notes what it is shown.
struct Observer : SetObserver {
  bool wants_journal() const override { return true; }
  void after_set(const SetOutcome& outcome, const ServerView&) override { sets.push_back(outcome.set.id.value); }
  void idle(const ServerView& view) override { facts = view.facts(); }
  void ending(const ServerView& view, const nlohmann::ordered_json&) override {
    finishing_with = view.facts();
    if (fails) throw UserError("nothing is written here");
  }
  void ended(const ServerView&, const nlohmann::ordered_json& report) override { reported = report.contains("server"); }

  std::vector<std::uint32_t> sets;
  LoopFacts facts, finishing_with;
  bool reported = false, fails = false;
};

TEST_F(ServerLoopTest, ShowsItsObserverWhatHappens) {
  Observer observer;
  loop_.observe(observer);
  EXPECT_TRUE(loop_.map_server().journal().enabled());
  const auto agent = join("cam0");
  EXPECT_TRUE(loop_.poll(0ms));
  EXPECT_THAT(observer.facts.agents, SizeIs(1)) << "also while no frames come";
  for (std::uint32_t i = 0; i < 5; ++i) {
    TrackFrame frame = values_.frame("cam0", RunId(last_run_), i, 20);
    frame.capture_ns = 33'333'333LL * i;
    agent->send(frame, {}, {});
  }
  EXPECT_TRUE(loop_.poll(0ms));
  EXPECT_GT(observer.facts.agents.at(0).bytes_up, 100U);
  EXPECT_GT(observer.facts.memory_mib, 1);
  EXPECT_FALSE(observer.facts.finishing);
  EXPECT_EQ(observer.facts.lost.at("sets_left_out"), 0U);
  loop_.finish({});
  EXPECT_THAT(observer.sets, ::testing::Not(::testing::IsEmpty()));
  EXPECT_TRUE(observer.finishing_with.finishing);
  EXPECT_TRUE(observer.reported);
}

TEST_F(ServerLoopTest, AnObserverThatFailsKeepsNothingFromTheOthers) {
  Observer first, second;
  first.fails = true;
  loop_.observe(first);
  loop_.observe(second);
  loop_.finish({});
  EXPECT_TRUE(second.finishing_with.finishing);
  EXPECT_TRUE(first.reported && second.reported);
}

TEST_F(ServerLoopTest, NonsenseForAReportIsLeftOut) {
  const std::string deep = R"({"a":)" + std::string(30000, '[') + std::string(30000, ']') + "}";
  for (const std::string& text : {deep, std::string("[1,2]"), std::string("{\"a\":"), std::string("\xff\xfe")}) {
    const auto agent = join("cam0");
    AgentStatus status = values_.agent_status("cam0", RunId(last_run_), AgentState::kFinished);
    status.report_json = text;
    agent->send(status);
    EXPECT_TRUE(loop_.poll(0ms));
    loop_.finish({});
    EXPECT_LT(loop_.report().dump().size(), 20000U) << text.substr(0, 20);
    EXPECT_GT(loop_.report()["agents"]["cam0"]["frames"], 0) << "what its status says counts all the same";
  }
}

}  // namespace
}  // namespace coslam::server_loop_test
