// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Agents and a server talk over the real middleware, through the loopback device.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "agent/link/dds_agent_link.h"
#include "common/wire/codec.h"
#include "common/wire/loop.h"
#include "common/wire/participant.h"
#include "deploy/coslam/run/inline_link.h"
#include "tests/server/fleet/link/speech.h"
#include "tests/support/planner.h"

namespace coslam::dds_link_test {
namespace {

using namespace std::chrono_literals;
using test::ChildProcess;
using test::EchoServer;
using test::expect_heard;
using test::expect_same;
using test::kServer;
using test::play;
using test::speech;
using test::Spoken;
using test::WireValues;
using testing::HasSubstr;

class DdsLinkTest : public test::DdsLinks {};

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

TEST_F(DdsLinkTest, AThumbnailComesWhenSomebodyLooks) {
  EchoServer server(config_, kServer);
  const auto link = open_agent_link(config_, WireValues(1).hello("cam0", RunId(1)));
  ASSERT_TRUE(server.serve_until_events<Hello>(1));
  EXPECT_FALSE(link->take_thumbnail_request()) << "nobody looks";
  const Thumbnail thumbnail = WireValues(2).thumbnail("cam0", RunId(1));
  std::optional<Thumbnail> seen;
  ASSERT_TRUE(server.serve_until([&] {
    seen = server.link().thumbnail("cam0");
    if (link->take_thumbnail_request()) link->send(thumbnail);
    return seen.has_value();
  }));
  expect_same(*seen, thumbnail);
  EXPECT_FALSE(server.link().thumbnail("cam1"));
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
    agent->send(WireValues(1).agent_status("cam0", RunId(1), AgentState::kFinished));
  }
  ASSERT_TRUE(server.serve_until_events<AgentGone>(1));
  EXPECT_EQ(server.of_type<AgentStatus>().back().state, AgentState::kFinished);
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

// In real time, over a link that carries less than they need.
TEST_F(DdsLinkTest, DescriptorsThatFollowTheirFrameAreAnnouncedAndBounded) {
  constexpr double kMost_bytes = 12e3;
  EchoServer server(config_, kServer);
  Hello hello = WireValues(1).hello("cam0", RunId(100));
  hello.pacing = Pacing::kLive;
  const auto link = open_agent_link(config_, hello);
  link->limit_replies({.bytes_a_frame = 4e3, .up_to_bytes = kMost_bytes});
  const std::vector<Spoken> said = speech("cam0", RunId(100), 3000);
  std::size_t next = 0;
  const auto say = [&](const std::optional<DescriptorReply>& descriptors) {
    if (next < said.size()) link->send(said[next++].frame, {}, descriptors);
  };
  ASSERT_TRUE(server.serve_until([&] {
    say({});
    return !server.of_type<JoinedFrame>().empty();
  }));
  DescriptorReply reply = WireValues(2).descriptors(said[next].frame, 800);
  say(reply);
  for (int i = 0; i < 10; ++i) say({});
  EXPECT_TRUE(link->waiting().descriptors);
  EXPECT_LT(link->waiting().sent_bytes, kMost_bytes + 2e3) << "what is not known to have arrived";
  link->limit_replies({.bytes_a_frame = 4e3, .up_to_bytes = 1e9});
  ASSERT_TRUE(server.serve_until([&] {
    say({});
    return server.of_type<JoinedFrame>().back().descriptors.has_value();
  }));
  const std::vector<JoinedFrame> heard = server.of_type<JoinedFrame>();
  expect_same(*heard.back().descriptors, reply);
  for (const JoinedFrame& j : heard) {
    EXPECT_EQ(j.frame.descriptors_sent == DescriptorsSent::kLater, j.frame.frame == reply.frame) << j.frame.frame.value;
  }
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
}  // namespace coslam::dds_link_test
