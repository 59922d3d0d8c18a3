// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Who comes late, goes, comes back or is reached elsewhere, over the real middleware.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "agent/link/dds_agent_link.h"
#include "common/base/error.h"
#include "tests/server/fleet/link/speech.h"

namespace coslam::dds_rejoin_test {
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

class DdsRejoinTest : public test::DdsLinks {};

TEST_F(DdsRejoinTest, AServerThatStartsLateHearsTheHello) {
  const Hello hello = WireValues(1).hello("cam0", RunId(5));
  const auto agent = open_agent_link(config_, hello);
  EXPECT_EQ(agent->server_status(), std::nullopt);
  EXPECT_FALSE(agent->server_alive());
  agent->send(WireValues(1).agent_status("cam0", RunId(5), AgentState::kWaiting));
  EchoServer server(config_, kServer);
  ASSERT_TRUE(server.serve_until_events<AgentStatus>(1));
  expect_same(std::get<Hello>(server.events().at(0)), hello);
  ASSERT_TRUE(agent->wait_server_status(test::kDeadline));
  EXPECT_TRUE(agent->server_alive());
}

TEST_F(DdsRejoinTest, AKilledAgentIsNoticed) {
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

TEST_F(DdsRejoinTest, AnAgentRestartedAtOnceIsTakenBack) {
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

TEST_F(DdsRejoinTest, AnAgentSurvivesTheRestartOfItsServer) {
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

TEST_F(DdsRejoinTest, AnAgentWhoseAddressChangesJoinsAnewAsTheSameRun) {
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

TEST_F(DdsRejoinTest, AServerWhoseAddressChangesJoinsAnewAndNoFrameIsLost) {
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

TEST_F(DdsRejoinTest, ASecondServerStepsBack) {
  EchoServer first(config_, RunId(1));
  const auto agent = open_agent_link(config_, WireValues(1).hello("cam0", RunId(9)));
  ASSERT_TRUE(first.serve_until_events<Hello>(1));
  const auto second = open_server_link(config_, RunId(2));
  try {
    while (true) EXPECT_EQ(second->next_event(100ms), std::nullopt) << "says nothing before it is sure";
  } catch (const UserError& e) {
    EXPECT_EQ(std::string(e.what()), "another map server is at work in DDS domain " + std::to_string(domain_.number()) +
                                         ": stop it, or choose another domain; coslam doctor says where it is");
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

TEST_F(DdsRejoinTest, OfTwoServersThatStartTogetherOneStepsBack) {
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

}  // namespace
}  // namespace coslam::dds_rejoin_test
