// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/run/inline_link.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/wire/codec.h"
#include "common/wire/participant.h"
#include "tests/support/wire_equal.h"
#include "tests/support/wire_values.h"

namespace coslam::inline_link_test {
namespace {

using namespace std::chrono_literals;
using test::expect_same;
using test::WireValues;

const RunId kServer(77);

// The next event, which must be of this type.
template <class Event>
Event expect_event(ServerLink& server) {
  auto event = server.next_event(0ms);
  if (!event || !std::holds_alternative<Event>(*event)) {
    ADD_FAILURE() << "no such event; index " << (event ? static_cast<int>(event->index()) : -1);
    return {};
  }
  return std::get<Event>(*event);
}

TEST(InlineLink, LockstepConversation) {
  WireValues values(1);
  InlineLink link(kServer);
  const Hello hello = values.hello("cam0", RunId(9));
  auto agent = link.connect(hello);
  expect_same(expect_event<Hello>(link.server()), hello);
  for (std::uint32_t i = 0; i < 10; ++i) {
    TrackFrame frame = values.frame("cam0", RunId(9), i);
    const PatchReply patches = values.patches(frame, 5);
    const DescriptorReply descriptors = values.descriptors(frame, 40);
    agent->send(frame, patches, descriptors);
    EXPECT_EQ(agent->wait_patch(FrameId(i), 1h), std::nullopt) << "no answer yet, and no waiting";
    EXPECT_TRUE(link.owes_answer(RunId(9)));

    const auto joined = expect_event<JoinedFrame>(link.server());
    frame.patches_sent = 5;
    frame.descriptors_sent = DescriptorsSent::kWithFrame;
    expect_same(joined.frame, frame);
    expect_same(*joined.patches, patches);
    expect_same(*joined.descriptors, descriptors);

    MapPatch patch = values.map_patch("cam0", RunId(9), i + 1);
    patch.after_frame = FrameId(i);
    link.server().send(patch);
    EXPECT_FALSE(link.owes_answer(RunId(9)));
    expect_same(*agent->wait_patch(FrameId(i), 0ms), patch);
    EXPECT_EQ(agent->wait_patch(FrameId(i), 1h), std::nullopt) << "answered";
  }
  agent->send(values.agent_status("cam0", RunId(9), AgentState::kFinished));
  agent.reset();
  EXPECT_EQ(expect_event<AgentStatus>(link.server()).state, AgentState::kFinished);
  EXPECT_EQ(expect_event<AgentGone>(link.server()).agent, "cam0");
  EXPECT_EQ(link.server().next_event(1h), std::nullopt);
}

TEST(InlineLink, StatusReachesEveryAgentAlsoLateOnes) {
  WireValues values(2);
  InlineLink link(kServer);
  auto first = link.connect(values.hello("cam0", RunId(1)));
  const ServerStatus status = values.server_status(kServer);
  link.server().send_status(status);
  auto second = link.connect(values.hello("cam1", RunId(2)));
  expect_same(*first->server_status(), status);
  expect_same(*second->wait_server_status(0ms), status);
  EXPECT_EQ(second->wait_server_status(1h), std::nullopt) << "nothing newer";
}

TEST(InlineLink, TheSameNameTwiceIsRefused) {
  WireValues values(3);
  InlineLink link(kServer);
  auto first = link.connect(values.hello("cam0", RunId(1)));
  auto second = link.connect(values.hello("cam0", RunId(2)));
  expect_event<Hello>(link.server());
  EXPECT_EQ(link.server().next_event(0ms), std::nullopt);
  EXPECT_EQ(refusal_of(*first->server_status(), RunId(1)), std::nullopt);
  EXPECT_THAT(refusal_of(*second->server_status(), RunId(2)).value_or(""), testing::HasSubstr("taken"));
  second->send(values.frame("cam0", RunId(2), 0), {}, {});
  EXPECT_EQ(link.server().rejections()[Rejection::kWrongRun], 1u);
}

TEST(InlineLink, ARestartIsANewHello) {
  WireValues values(4);
  InlineLink link(kServer);
  link.connect(values.hello("cam0", RunId(1)));  // ends at once
  auto second = link.connect(values.hello("cam0", RunId(2)));
  EXPECT_EQ(expect_event<Hello>(link.server()).agent_run, RunId(1));
  EXPECT_EQ(expect_event<AgentGone>(link.server()).agent_run, RunId(1));
  EXPECT_EQ(expect_event<Hello>(link.server()).agent_run, RunId(2));
}

TEST(InlineLink, BothEndsCountTheSameBytes) {
  WireValues values(5);
  InlineLink link(kServer);
  auto agent = link.connect(values.hello("cam0", RunId(1)));
  const LinkBytes before = agent->bytes();
  const TrackFrame frame = values.frame("cam0", RunId(1), 0, 300);
  agent->send(frame, {}, {});
  const MapPatch patch = values.map_patch("cam0", RunId(1), 1);
  link.server().send(patch);
  const auto message = encode(frame, pixel_scale(test::vga_camera()));
  EXPECT_EQ(agent->bytes().up - before.up, link_bytes(sample_bytes(message), 1400));
  EXPECT_EQ(agent->bytes().down - before.down, link_bytes(sample_bytes(encode(patch)), 1400));
  EXPECT_EQ(link.server().bytes("cam0").up, agent->bytes().up);
}

TEST(InlineLink, RefusedByTheServer) {
  WireValues values(6);
  InlineLink link(kServer);
  auto agent = link.connect(values.hello("stranger", RunId(1)));
  link.server().refuse(expect_event<Hello>(link.server()), "the sequence has no agent 'stranger'");
  EXPECT_EQ(refusal_of(*agent->server_status(), RunId(1)), "the sequence has no agent 'stranger'");
  agent->send(values.frame("stranger", RunId(1), 0), {}, {});
  EXPECT_EQ(link.server().next_event(0ms), std::nullopt);
}

}  // namespace
}  // namespace coslam::inline_link_test
