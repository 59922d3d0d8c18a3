// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/server_loop.h"

#include <gmock/gmock.h>

#include "server/link/inline_link.h"
#include "tests/support/wire_values.h"

namespace coslam {
namespace {

using namespace std::chrono_literals;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::SizeIs;

const RunId kServer(1);

// A server without a map to speak of, and agents that come and go.
class ServerLoopTest : public ::testing::Test {
 protected:
  std::unique_ptr<AgentLink> join(const std::string& name) {
    auto agent = link_.connect(values_.hello(name, RunId(++last_run_), Pacing::kLive));
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
  come_and_go(ServerLoop::kMostAgents);
  const auto late = join("late");
  EXPECT_THAT(refusal_of(*late->server_status(), RunId(last_run_)).value_or(""), HasSubstr("1000 agents"));
  const auto known = join("cam7");
  EXPECT_EQ(refusal_of(*known->server_status(), RunId(last_run_)), std::nullopt) << "its camera is there already";
  loop_.finish({});
  EXPECT_THAT(known->server_status()->agents, Contains("cam7"));
}

}  // namespace
}  // namespace coslam
