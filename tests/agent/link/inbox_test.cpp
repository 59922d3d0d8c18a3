// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/link/inbox.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "agent/link/agent_link.h"
#include "common/base/error.h"
#include "tests/support/wire_values.h"

namespace coslam::inbox_test {
namespace {

const RunId kMe(9);

MapPatch patch(std::uint32_t sequence, std::uint32_t after_frame, std::uint64_t server_run = 1, RunId to = kMe) {
  MapPatch p;
  p.agent = "cam0";
  p.agent_run = to;
  p.server_run = RunId(server_run);
  p.sequence = sequence;
  p.after_frame = FrameId(after_frame);
  return p;
}

ServerStatus status(std::uint64_t server_run) {
  ServerStatus s;
  s.server_run = RunId(server_run);
  return s;
}

std::vector<std::uint32_t> drain(Inbox& inbox) {
  std::vector<std::uint32_t> sequences;
  while (auto p = inbox.pop()) sequences.push_back(p->sequence);
  return sequences;
}

using testing::ElementsAre;

TEST(Inbox, PatchesKeepTheirOrder) {
  Inbox inbox(kMe);
  for (const std::uint32_t i : {1u, 2u, 3u}) EXPECT_EQ(inbox.add(patch(i, i)), std::nullopt);
  EXPECT_THAT(drain(inbox), ElementsAre(1, 2, 3));
}

TEST(Inbox, AGapIsPassedOnForTheAgentToSee) {
  Inbox inbox(kMe);
  inbox.add(patch(1, 1));
  EXPECT_EQ(inbox.add(patch(4, 4)), std::nullopt);
  EXPECT_THAT(drain(inbox), ElementsAre(1, 4));
}

TEST(Inbox, TheSamePatchTwiceCountsOnce) {
  Inbox inbox(kMe);
  inbox.add(patch(1, 1));
  inbox.add(patch(2, 2));
  EXPECT_EQ(inbox.add(patch(2, 2)), Rejection::kDuplicate);
  EXPECT_THAT(drain(inbox), ElementsAre(1, 2));
  EXPECT_EQ(inbox.add(patch(1, 1)), Rejection::kDuplicate) << "also after it was read";
}

TEST(Inbox, PatchesForAnotherRunAreNotMine) {
  Inbox inbox(kMe);
  EXPECT_EQ(inbox.add(patch(1, 1, 1, RunId(8))), Rejection::kWrongRun);
}

TEST(Inbox, ANewServerRunStartsOver) {
  Inbox inbox(kMe);
  inbox.add(patch(1, 1));
  inbox.add(patch(2, 2));
  EXPECT_EQ(inbox.add(patch(1, 3, 2)), std::nullopt);
  EXPECT_THAT(drain(inbox), ElementsAre(1)) << "what the server before had said is void";
  EXPECT_EQ(inbox.add(patch(3, 4, 1)), Rejection::kWrongRun) << "and it cannot come back";
  EXPECT_EQ(inbox.add(status(1)), Rejection::kWrongRun);
  EXPECT_EQ(inbox.add(status(2)), std::nullopt);
}

// Whether by mistake or in ill will: a second one does not take the agent away.
TEST(Inbox, NoOtherServerIsHeardWhileOursLives) {
  Inbox inbox(kMe);
  EXPECT_EQ(inbox.add(status(1)), std::nullopt);
  inbox.set_server_alive(true);
  EXPECT_EQ(inbox.add(status(2)), Rejection::kWrongRun);
  EXPECT_EQ(inbox.add(patch(1, 0, 2)), Rejection::kWrongRun);
  EXPECT_EQ(inbox.add(patch(1, 0, 1)), std::nullopt);
  inbox.set_server_alive(false);
  EXPECT_EQ(inbox.add(status(2)), std::nullopt) << "it was restarted";
  inbox.set_server_alive(true);
  EXPECT_EQ(inbox.add(status(1)), Rejection::kWrongRun);
}

TEST(Inbox, CreditIsGivenByThePatchThatWasRead) {
  Inbox inbox(kMe);
  EXPECT_FALSE(inbox.answered(FrameId(0)));
  inbox.add(patch(1, 0));
  EXPECT_FALSE(inbox.answered(FrameId(0))) << "arrived, not read";
  inbox.pop();
  EXPECT_TRUE(inbox.answered(FrameId(0)));
  EXPECT_FALSE(inbox.answered(FrameId(1)));
  inbox.add(patch(2, 5));
  inbox.add(patch(3, 5));
  drain(inbox);
  EXPECT_TRUE(inbox.answered(FrameId(4)));
}

TEST(Inbox, AcknowledgedIsWhatThePresentServerAnswered) {
  Inbox inbox(kMe);
  EXPECT_EQ(inbox.acknowledged(), std::nullopt);
  inbox.add(patch(1, 7));
  EXPECT_EQ(inbox.acknowledged(), FrameId(7)) << "also before it was read";
  inbox.add(patch(1, 9));
  EXPECT_EQ(inbox.acknowledged(), FrameId(7)) << "the same patch twice";
  inbox.add(patch(2, 8));
  inbox.add(status(1));
  EXPECT_EQ(inbox.acknowledged(), FrameId(8));
  inbox.add(status(2));
  EXPECT_EQ(inbox.acknowledged(), std::nullopt) << "another server has none of the frames";
  inbox.add(patch(3, 9, 1));
  EXPECT_EQ(inbox.acknowledged(), std::nullopt);
  inbox.add(patch(1, 9, 2));
  EXPECT_EQ(inbox.acknowledged(), FrameId(9));
}

TEST(Inbox, OverflowDropsTheOldestAndSaysSo) {
  Inbox inbox(kMe);
  for (std::uint32_t i = 1; i <= Inbox::kCapacity; ++i) EXPECT_EQ(inbox.add(patch(i, i)), std::nullopt);
  EXPECT_EQ(inbox.add(patch(Inbox::kCapacity + 1, 0)), Rejection::kOverflow);
  EXPECT_EQ(inbox.pop()->sequence, 2u);
}

TEST(Inbox, StatusIsFreshOnce) {
  Inbox inbox(kMe);
  EXPECT_EQ(inbox.take_fresh_status(), std::nullopt);
  inbox.add(status(1));
  EXPECT_TRUE(inbox.take_fresh_status());
  EXPECT_FALSE(inbox.take_fresh_status());
  EXPECT_TRUE(inbox.status()) << "but stays readable";
}

TEST(RequireValid, NamesWhatIsWrong) {
  test::WireValues values(1);
  const auto error_of = [](const Hello& hello) -> std::string {
    try {
      require_valid(hello);
    } catch (const UserError& e) {
      return e.what();
    }
    return "";
  };
  Hello hello = values.hello("cam0", kMe);
  EXPECT_EQ(error_of(hello), "");
  hello.agent = "left camera";
  EXPECT_THAT(error_of(hello), testing::HasSubstr("agent name 'left camera' is not valid"));
  hello = values.hello("cam0", kMe);
  hello.camera.fx = 0;
  EXPECT_THAT(error_of(hello), testing::HasSubstr("calibration of agent 'cam0': the focal lengths must be positive"));
  hello = values.hello("cam0", RunId(0));
  EXPECT_THAT(error_of(hello), testing::HasSubstr("bad_id"));
}

}  // namespace
}  // namespace coslam::inbox_test
