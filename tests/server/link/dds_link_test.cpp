// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Agents and a server talk over the real middleware, through the loopback device.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "agent/link/dds_agent_link.h"
#include "common/base/error.h"
#include "common/wire/codec.h"
#include "common/wire/loop.h"
#include "common/wire/participant.h"
#include "server/link/inline_link.h"
#include "tests/server/link/echo_server.h"
#include "tests/support/child_process.h"
#include "tests/support/planner.h"
#include "tests/support/test_domain.h"
#include "tests/support/wire_equal.h"
#include "tests/support/wire_values.h"

namespace coslam {
namespace {

using namespace std::chrono_literals;
using test::ChildProcess;
using test::EchoServer;
using test::expect_same;
using test::WireValues;
using testing::HasSubstr;

const RunId kServer(77);

class DdsLinkTest : public testing::Test {
 protected:
  ChildProcess agent_child(const std::string& name, std::uint64_t run) const {
    return ChildProcess({LINK_CHILD, "agent", std::to_string(domain_.number()), name, std::to_string(run)});
  }
  ChildProcess server_child(std::uint64_t run) const {
    return ChildProcess({LINK_CHILD, "server", std::to_string(domain_.number()), std::to_string(run)});
  }

  test::TestDomain domain_;
  WireConfig config_ = loopback_config(domain_.number());
};

struct Spoken {
  TrackFrame frame;
  std::optional<PatchReply> patches;
  std::optional<DescriptorReply> descriptors;
};

// Frames of an agent, some with replies.
std::vector<Spoken> speech(const std::string& name, RunId run, std::uint32_t frames) {
  WireValues values(run.value);
  std::vector<Spoken> all;
  for (std::uint32_t i = 0; i < frames; ++i) {
    Spoken s{values.frame(name, run, i), {}, {}};
    if (i % 3 == 1) s.patches = values.patches(s.frame, 30);
    if (i % 10 == 5) s.descriptors = values.descriptors(s.frame, 800);
    s.frame.patches_sent = s.patches ? 30 : 0;
    s.frame.descriptors_sent = s.descriptors.has_value();
    all.push_back(std::move(s));
  }
  return all;
}

// Plays in lock-step; returns the number of frames that were answered.
std::uint32_t play(AgentLink& link, const std::vector<Spoken>& all) {
  std::uint32_t answered = 0;
  for (const Spoken& s : all) {
    link.send(s.frame, s.patches, s.descriptors);
    std::optional<MapPatch> patch;
    do {
      patch = link.wait_patch(s.frame.frame, test::kDeadline);
    } while (patch && patch->after_frame < s.frame.frame);
    if (!patch) break;
    ++answered;
  }
  return answered;
}

void expect_heard(const std::vector<JoinedFrame>& heard, const std::vector<Spoken>& all) {
  ASSERT_EQ(heard.size(), all.size()) << "every frame once";
  for (std::size_t i = 0; i < all.size(); ++i) {
    expect_same(heard[i].frame, all[i].frame);
    ASSERT_EQ(heard[i].patches.has_value(), all[i].patches.has_value());
    if (heard[i].patches) expect_same(*heard[i].patches, *all[i].patches);
    ASSERT_EQ(heard[i].descriptors.has_value(), all[i].descriptors.has_value());
    if (heard[i].descriptors) expect_same(*heard[i].descriptors, *all[i].descriptors);
  }
}

TEST_F(DdsLinkTest, LockstepLosesNothingAndChangesNoBit) {
  constexpr std::uint32_t kFrames = 150;
  EchoServer server(config_, kServer);
  const std::array<std::string, 2> names = {"cam0", "cam1"};
  std::array<std::vector<Spoken>, 2> said;
  std::array<LinkBytes, 2> bytes;
  std::atomic<int> done{0};
  std::vector<std::jthread> agents;
  for (std::size_t a = 0; a < 2; ++a) {
    said[a] = speech(names[a], RunId(100 + a), kFrames);
    agents.emplace_back([&, a] {
      const auto link = open_agent_link(config_, WireValues(1).hello(names[a], RunId(100 + a)));
      EXPECT_EQ(play(*link, said[a]), kFrames);
      bytes[a] = link->bytes();
      ++done;
    });
  }
  EXPECT_TRUE(server.serve_until([&] { return done == 2; }));
  agents.clear();
  for (std::size_t a = 0; a < 2; ++a) {
    expect_heard(server.of_type<JoinedFrame>([&](const JoinedFrame& j) { return j.frame.agent == names[a]; }), said[a]);
    // Frames that came before the way back was open are not counted as the agent's.
    EXPECT_NEAR(static_cast<double>(server.link().bytes(names[a]).up), static_cast<double>(bytes[a].up), 20000);
    EXPECT_GT(bytes[a].down, 0u);
  }
}

TEST_F(DdsLinkTest, WhatMovesIsHeardByWhoeverReadsIt) {
  const MovingState state = WireValues(4).moving_state(12, 11);
  EchoServer server(config_, kServer);
  server.link().send(state);  // nobody reads it yet
  test::Planner planner(config_);
  std::optional<MovingState> heard;
  ASSERT_TRUE(server.serve_until([&] {
    server.link().send(state);
    heard = planner.newest();
    return heard.has_value();
  }));
  expect_same(*heard, state);
}

TEST_F(DdsLinkTest, AServerThatStartsLateHearsTheHello) {
  const Hello hello = WireValues(1).hello("cam0", RunId(5));
  const auto agent = open_agent_link(config_, hello);
  EXPECT_EQ(agent->server_status(), std::nullopt);
  EXPECT_FALSE(agent->server_alive());
  agent->send_status(WireValues(1).agent_status("cam0", RunId(5), AgentState::kWaiting));
  EchoServer server(config_, kServer);
  ASSERT_TRUE(server.serve_until_events<AgentStatus>(1));
  expect_same(std::get<Hello>(server.events().at(0)), hello);
  ASSERT_TRUE(agent->wait_server_status(test::kDeadline));
  EXPECT_TRUE(agent->server_alive());
}

TEST_F(DdsLinkTest, AKilledAgentIsNoticed) {
  EchoServer server(config_, kServer);
  const auto bystander = open_agent_link(config_, WireValues(1).hello("cam1", RunId(2)));
  ChildProcess child = agent_child("cam0", 1);
  const auto from_child = [](const auto& e) { return e.agent == "cam0"; };
  ASSERT_TRUE(server.serve_until([&] { return server.of_type<JoinedFrame>().size() >= 10; }));
  const auto killed = std::chrono::steady_clock::now();
  child.kill(SIGKILL);
  ASSERT_TRUE(server.serve_until_events<AgentSilent>(1, from_child));
  const auto silent = std::chrono::steady_clock::now();
  ASSERT_TRUE(server.serve_until_events<AgentGone>(1, from_child));
  const auto gone = std::chrono::steady_clock::now();
  EXPECT_LT(silent - killed, 2s) << "nominally half a second";
  EXPECT_LT(gone - killed, 6s) << "nominally the lease of three seconds";
  EXPECT_TRUE(server.of_type<AgentGone>([](const AgentGone& e) { return e.agent == "cam1"; }).empty());
  RecordProperty("silent_ms", static_cast<int>(std::chrono::duration<double, std::milli>(silent - killed).count()));
  RecordProperty("gone_ms", static_cast<int>(std::chrono::duration<double, std::milli>(gone - killed).count()));
}

TEST_F(DdsLinkTest, AnAgentRestartedAtOnceIsTakenBack) {
  EchoServer server(config_, kServer);
  const auto frames_of = [&](std::uint64_t run) {
    return server.of_type<JoinedFrame>([run](const JoinedFrame& j) { return j.frame.agent_run == RunId(run); }).size();
  };
  ChildProcess first = agent_child("cam0", 1);
  ASSERT_TRUE(server.serve_until([&] { return frames_of(1) >= 5; }));
  first.kill(SIGKILL);
  ChildProcess second = agent_child("cam0", 2);
  EXPECT_TRUE(server.serve_until([&] { return frames_of(2) >= 5; }));
  const auto hellos = server.of_type<Hello>();
  ASSERT_EQ(hellos.size(), 2u);
  EXPECT_EQ(hellos[1].agent_run, RunId(2));
}

TEST_F(DdsLinkTest, ASecondAgentOfTheSameNameIsRefused) {
  EchoServer server(config_, kServer);
  const auto first = open_agent_link(config_, WireValues(1).hello("cam0", RunId(1)));
  ASSERT_TRUE(server.serve_until_events<Hello>(1));
  const auto second = open_agent_link(config_, WireValues(1).hello("cam0", RunId(2)));
  std::optional<std::string> reason;
  EXPECT_TRUE(server.serve_until([&] {
    const auto status = second->server_status();
    reason = status ? refusal_of(*status, RunId(2)) : std::nullopt;
    return reason.has_value();
  }));
  EXPECT_THAT(reason.value_or(""), HasSubstr("the name 'cam0' is taken by a running agent"));
  EXPECT_EQ(refusal_of(*first->server_status(), RunId(1)), std::nullopt);
  EXPECT_EQ(server.of_type<Hello>().size(), 1u);
}

TEST_F(DdsLinkTest, AnotherProtocolIsRefused) {
  EchoServer server(config_, kServer);
  Hello hello = WireValues(1).hello("cam0", RunId(1));
  hello.protocol = 99;
  const auto agent = open_agent_link(config_, hello);
  EXPECT_TRUE(server.serve_until([&] {
    const auto status = agent->server_status();
    return status && refusal_of(*status, RunId(1)).value_or("").find("speaks protocol 99") != std::string::npos;
  }));
  EXPECT_EQ(server.link().rejections()[Rejection::kWrongProtocol], 1u);
}

TEST_F(DdsLinkTest, TheLastStatusArrivesBeforeTheEnd) {
  EchoServer server(config_, kServer);
  {
    const auto agent = open_agent_link(config_, WireValues(1).hello("cam0", RunId(1)));
    ASSERT_TRUE(server.serve_until_events<Hello>(1));
    agent->send_status(WireValues(1).agent_status("cam0", RunId(1), AgentState::kFinished));
  }
  ASSERT_TRUE(server.serve_until_events<AgentGone>(1));
  EXPECT_EQ(server.of_type<AgentStatus>().back().state, AgentState::kFinished);
}

TEST_F(DdsLinkTest, AnAgentSurvivesTheRestartOfItsServer) {
  const auto agent = open_agent_link(config_, WireValues(1).hello("cam0", RunId(1)));
  const std::vector<Spoken> said = speech("cam0", RunId(1), 40);
  const std::vector<Spoken> before(said.begin(), said.begin() + 20), after(said.begin() + 20, said.end());
  {
    ChildProcess first = server_child(50);
    EXPECT_EQ(play(*agent, before), 20u);
    EXPECT_EQ(agent->server_status()->server_run, RunId(50));
    first.kill(SIGKILL);
  }
  EchoServer second(config_, RunId(51));
  std::atomic<bool> done{false};
  std::jthread player([&] {
    EXPECT_EQ(play(*agent, after), 20u);
    done = true;
  });
  EXPECT_TRUE(second.serve_until([&] { return done.load(); }));
  player.join();
  expect_heard(second.of_type<JoinedFrame>(), after);
  EXPECT_EQ(agent->server_status()->server_run, RunId(51));
}

TEST_F(DdsLinkTest, AnAgentWhoseAddressChangesJoinsAnewAsTheSameRun) {
  EchoServer server(config_, kServer);
  std::atomic<int> lease{1};
  const auto agent = open_agent_link(config_, WireValues(1).hello("cam0", RunId(1)), [&] {
    return std::vector<std::string>{"127.0.0.1", "10.0.0." + std::to_string(lease)};
  });
  const std::vector<Spoken> said = speech("cam0", RunId(1), 60);
  const std::vector<Spoken> before(said.begin(), said.begin() + 20), meanwhile(said.begin() + 20, said.begin() + 40),
      after(said.begin() + 40, said.end());
  std::atomic<bool> back{false}, done{false};
  std::jthread player([&] {
    EXPECT_EQ(play(*agent, before), 20u);
    lease = 2;
    EXPECT_EQ(play(*agent, meanwhile), 20u);
    back.wait(false);
    EXPECT_EQ(play(*agent, after), 20u);
    done = true;
  });
  EXPECT_TRUE(server.serve_until_events<Hello>(2));
  back = true;
  back.notify_all();
  EXPECT_TRUE(server.serve_until([&] { return done.load(); }));
  player.join();
  EXPECT_EQ(server.of_type<AgentGone>().size(), 1u);
  EXPECT_EQ(server.of_type<Hello>().size(), 2u);
  expect_heard(server.of_type<JoinedFrame>(), said);
}

TEST_F(DdsLinkTest, AServerWhoseAddressChangesJoinsAnewAndNoFrameIsLost) {
  std::atomic<int> lease{1};
  EchoServer server(config_, kServer, [&] {
    return std::vector<std::string>{"127.0.0.1", "10.0.0." + std::to_string(lease)};
  });
  const auto agent = open_agent_link(config_, WireValues(1).hello("cam0", RunId(1)));
  const std::vector<Spoken> said = speech("cam0", RunId(1), 40);
  const std::vector<Spoken> before(said.begin(), said.begin() + 20), after(said.begin() + 20, said.end());
  std::atomic<bool> done{false};
  std::jthread player([&] {
    EXPECT_EQ(play(*agent, before), 20u);
    lease = 2;
    while (agent->server_alive()) std::this_thread::yield();
    EXPECT_EQ(play(*agent, after), 20u);
    done = true;
  });
  EXPECT_TRUE(server.serve_until([&] { return done.load(); }));
  player.join();
  EXPECT_EQ(server.of_type<AgentSilent>().size(), 1u);
  EXPECT_TRUE(server.of_type<AgentGone>().empty());
  EXPECT_EQ(agent->server_status()->server_run, kServer);
  expect_heard(server.of_type<JoinedFrame>(), said);
}

TEST_F(DdsLinkTest, ASecondServerStepsBack) {
  EchoServer first(config_, RunId(1));
  const auto agent = open_agent_link(config_, WireValues(1).hello("cam0", RunId(9)));
  ASSERT_TRUE(first.serve_until_events<Hello>(1));
  const auto second = open_server_link(config_, RunId(2));
  try {
    while (true) EXPECT_EQ(second->next_event(100ms), std::nullopt) << "says nothing before it is sure";
  } catch (const UserError& e) {
    EXPECT_EQ(std::string(e.what()), "another map server is at work in DDS domain " + std::to_string(domain_.number()) +
                                         ": stop it, or choose another domain");
  }
  const std::vector<Spoken> said = speech("cam0", RunId(9), 3);
  std::atomic<bool> done{false};
  const std::jthread player([&] {
    EXPECT_EQ(play(*agent, said), 3u);
    done = true;
  });
  EXPECT_TRUE(first.serve_until([&] { return done.load(); })) << "the first goes on as if nothing had been";
  EXPECT_EQ(agent->server_status()->server_run, RunId(1));
}

TEST_F(DdsLinkTest, OfTwoServersThatStartTogetherOneStepsBack) {
  const auto one = open_server_link(config_, RunId(100)), two = open_server_link(config_, RunId(900));
  const auto steps_back = [](ServerLink& server) {
    try {
      server.next_event(1ms);
    } catch (const UserError&) {
      return true;
    }
    return false;
  };
  const auto end = std::chrono::steady_clock::now() + test::kDeadline;
  bool first = false, second = false;
  while (!first && !second && std::chrono::steady_clock::now() < end) {
    first = steps_back(*one);
    second = steps_back(*two);
  }
  EXPECT_NE(first, second);
}

TEST_F(DdsLinkTest, TwelveProcessesThatStartTogetherFindTheServer) {
  EchoServer server(config_, kServer);
  std::vector<std::unique_ptr<ChildProcess>> agents;
  for (std::uint64_t a = 0; a < 12; ++a) {
    agents.push_back(std::make_unique<ChildProcess>(std::vector<std::string>{
        LINK_CHILD, "agent", std::to_string(domain_.number()), "cam" + std::to_string(a), std::to_string(100 + a)}));
  }
  EXPECT_TRUE(server.serve_until_events<Hello>(12));
  EXPECT_TRUE(server.serve_until([&] {
    const auto last = server.of_type<JoinedFrame>([](const JoinedFrame& j) { return j.frame.frame == FrameId(3); });
    return last.size() == 12;
  }));
}

TEST_F(DdsLinkTest, TwelveAgentsAtOnce) {
  constexpr std::uint32_t kFrames = 20;
  EchoServer server(config_, kServer);
  std::atomic<int> done{0};
  std::vector<std::jthread> agents;
  for (std::uint64_t a = 0; a < 12; ++a) {
    agents.emplace_back([&, a] {
      const std::string name = "cam" + std::to_string(a);
      const auto link = open_agent_link(config_, WireValues(a).hello(name, RunId(100 + a)));
      EXPECT_EQ(play(*link, speech(name, RunId(100 + a), kFrames)), kFrames);
      ++done;
    });
  }
  EXPECT_TRUE(server.serve_until([&] { return done == 12; }));
  EXPECT_EQ(server.of_type<Hello>().size(), 12u);
  EXPECT_EQ(server.of_type<JoinedFrame>().size(), 12u * kFrames);
}

TEST_F(DdsLinkTest, AFrameSentAgainIsDeliveredOnceAndAnsweredAgain) {
  const auto server = open_server_link(config_, kServer);
  const auto agent = open_agent_link(config_, WireValues(1).hello("cam0", RunId(1)));
  const TrackFrame frame = WireValues(1).frame("cam0", RunId(1), 0);
  const std::jthread player([&] {
    agent->send(frame, {}, {});
    const auto patch = agent->wait_patch(FrameId(0), test::kDeadline);
    EXPECT_TRUE(patch);
  });
  // A slow server: the agent repeats itself, and the repetition is dropped.
  const auto end = std::chrono::steady_clock::now() + test::kDeadline;
  int frames = 0;
  while (server->rejections()[Rejection::kDuplicate] == 0 && std::chrono::steady_clock::now() < end) {
    const auto event = server->next_event(20ms);
    frames += event && std::holds_alternative<JoinedFrame>(*event) ? 1 : 0;
  }
  EXPECT_EQ(frames, 1);
  EXPECT_EQ(server->counts().resent_patches, 0u) << "there was no answer to repeat";
  MapPatch patch = WireValues(2).map_patch("cam0", RunId(1), 1, 5);
  patch.after_frame = FrameId(0);
  server->send(patch);
}

TEST_F(DdsLinkTest, AFrameThatCouldNotBeUsedComesAgainAndStandsAlone) {
  // A server made by hand, which answers the first frame and says nothing to the second.
  const RunId run(1);
  Participant participant(config_, "test");
  test::Collector<idl::TrackFrame> frames;
  Loop loop(participant, "server", 50ms, [] {});
  loop.read<idl::TrackFrame>([&](const idl::TrackFrame& m, const Sample&) { frames.add(m); });
  loop.start();
  Writer<idl::MapPatch> patches(participant, partition_of(run));
  const auto agent = open_agent_link(config_, WireValues(1).hello("cam0", run));
  const std::jthread player([&] { EXPECT_EQ(play(*agent, speech("cam0", run, 2)), 2U); });
  const auto answer = [&](std::uint32_t frame) {
    MapPatch patch = WireValues(2).map_patch("cam0", run, frame + 1, 5);
    patch.after_frame = FrameId(frame);
    patches.write(encode(patch));
  };
  const auto of_frame = [&](std::uint32_t frame, std::size_t count) {
    std::vector<idl::TrackFrame> found;
    EXPECT_TRUE(frames.wait([&](const auto& all) {
      found.clear();
      std::ranges::copy_if(all, std::back_inserter(found), [&](const auto& m) { return m.frame() == frame; });
      return found.size() >= count && patches.readers() > 0;
    }));
    return found;
  };
  of_frame(0, 1);
  answer(0);
  const auto twice = of_frame(1, 2);
  ASSERT_GE(twice.size(), 2U);
  EXPECT_EQ(twice[0].reference_age(), 1);
  EXPECT_EQ(twice[1].reference_age(), 0);
  answer(1);
}

TEST_F(DdsLinkTest, AnAnswerThatWasLostIsSentAgain) {
  // An agent made by hand, since a real one does not repeat a frame that was answered.
  Participant participant(config_, "test");
  test::Collector<idl::MapPatch> patches;
  Loop loop(participant, "agent", 50ms, [] {});
  loop.read<idl::MapPatch>([&](const idl::MapPatch& m, const Sample&) { patches.add(m); }, {}, partition_of(RunId(1)));
  loop.start();
  Writer<idl::TrackFrame> tracks(participant);
  Writer<idl::Hello> hello(participant);
  Writer<idl::AgentStatus> status(participant);
  hello.write(encode(WireValues(1).hello("cam0", RunId(1))));
  status.write(encode(WireValues(1).agent_status("cam0", RunId(1))));
  EchoServer server(config_, kServer);
  ASSERT_TRUE(server.serve_until_events<Hello>(1));
  const auto frame = encode(WireValues(1).frame("cam0", RunId(1), 0), pixel_scale(test::vga_camera()));
  EXPECT_TRUE(server.serve_until([&] {
    tracks.write(frame);
    return patches.values().size() >= 3;
  }));
  EXPECT_EQ(server.of_type<JoinedFrame>().size(), 1u);
  for (const idl::MapPatch& p : patches.values()) EXPECT_EQ(p, patches.values()[0]);
  EXPECT_GE(server.link().counts().resent_patches, 2u);
}

// What the middleware lets it find may come seconds late where words of discovery are lost.
TEST_F(DdsLinkTest, AnAgentIsLetInWhenItSaysThatItHears) {
  Participant participant(config_, "test");
  Loop loop(participant, "agent", 50ms, [] {});
  loop.read<idl::MapPatch>([](const idl::MapPatch&, const Sample&) {}, {}, partition_of(RunId(1)));
  loop.start();
  Writer<idl::Hello> hello(participant);
  Writer<idl::AgentStatus> status(participant);
  hello.write(encode(WireValues(1).hello("deaf", RunId(1))));
  EchoServer server(config_, kServer);
  const auto whole = open_agent_link(config_, WireValues(1).hello("whole", RunId(2)));
  ASSERT_TRUE(server.serve_until([&] { return loop.writers<idl::MapPatch>() > 0; }));
  ASSERT_TRUE(server.serve_until_events<Hello>(1));
  EXPECT_EQ(server.of_type<Hello>()[0].agent, "whole");
  status.write(encode(WireValues(1).agent_status("deaf", RunId(1))));
  ASSERT_TRUE(server.serve_until_events<Hello>(2));
}

TEST_F(DdsLinkTest, TheInlineLinkCarriesTheSameBitsAndBytes) {
  const std::vector<Spoken> said = speech("cam0", RunId(1), 20);
  const Hello hello = WireValues(1).hello("cam0", RunId(1));
  EchoServer server(config_, kServer);
  std::uint64_t up_dds = 0;
  std::atomic<bool> done{false};
  {
    const std::jthread player([&] {
      const auto link = open_agent_link(config_, hello);
      link->wait_server_status(test::kDeadline);
      EXPECT_EQ(play(*link, said), 20u);
      up_dds = link->bytes().up;
      done = true;
    });
    EXPECT_TRUE(server.serve_until([&] { return done.load(); }));
  }
  InlineLink inlined(kServer);
  const auto agent = inlined.connect(hello);
  for (const Spoken& s : said) agent->send(s.frame, s.patches, s.descriptors);
  std::vector<JoinedFrame> heard;
  while (auto event = inlined.server().next_event(0ms)) {
    if (auto* joined = std::get_if<JoinedFrame>(&*event)) heard.push_back(std::move(*joined));
  }
  const auto over_dds = server.of_type<JoinedFrame>();
  ASSERT_EQ(heard.size(), over_dds.size());
  for (std::size_t i = 0; i < heard.size(); ++i) expect_same(heard[i].frame, over_dds[i].frame);
  // Repetitions while the first contact is made cost extra bytes over DDS.
  EXPECT_GE(up_dds, agent->bytes().up);
  EXPECT_LE(up_dds, agent->bytes().up + 10 * 2000);
}

}  // namespace
}  // namespace coslam
