// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/link/link_governor.h"

#include <gtest/gtest.h>

namespace coslam::link_governor_test {
namespace {

constexpr double kRate_hz = 30;
constexpr TimeNs kMs = 1'000'000;

Instant at(double s) {
  return Instant(std::chrono::duration_cast<Instant::duration>(std::chrono::duration<double>(100 + s)));
}

class LinkGovernorTest : public testing::Test {
 protected:
  // A second in which each frame waits so long on the link, and is answered at once.
  void play(double wait_s, bool replies_wait = false) {
    for (int i = 0; i < 30; ++i, ++frame_) {
      const double now_s = frame_ / kRate_hz;
      const bool due = governor_.due(static_cast<TimeNs>(now_s * 1e9));
      sent_ += due ? 1 : 0;
      if (due) governor_.sent(FrameId(static_cast<std::uint32_t>(frame_)), at(now_s), 0, 1000.0 * frame_);
      MapPatch patch;
      patch.after_frame = FrameId(static_cast<std::uint32_t>(frame_));
      patch.sent_ns = static_cast<TimeNs>(now_s * 1e9) + kMs;
      patch.received_ns = patch.sent_ns + kMs;
      patch.uplink_wait_s = static_cast<float>(wait_s);
      limits_ = governor_.heard({patch}, replies_wait, true, at(now_s));
    }
  }

  LinkGovernor governor_{kRate_hz};
  ReplyLimits limits_;
  int frame_ = 0, sent_ = 0;
};

TEST_F(LinkGovernorTest, AWideLinkCarriesEverything) {
  for (int i = 0; i < 5; ++i) play(0);
  sent_ = 0;
  play(0);
  EXPECT_EQ(sent_, 30);
  EXPECT_FALSE(governor_.narrow());
  EXPECT_FALSE(governor_.room().patches);
  EXPECT_FALSE(governor_.room().features);
}

TEST_F(LinkGovernorTest, WhereFramesWaitFewerAreSentAndLessIsAnswered) {
  for (int i = 0; i < 5; ++i) play(0);
  for (int i = 0; i < 3; ++i) play(1.5);
  sent_ = 0;
  play(1.5);
  EXPECT_LT(sent_, 20);
  EXPECT_TRUE(governor_.thins_frames());
  EXPECT_TRUE(governor_.narrow());
  EXPECT_TRUE(limits_.narrow_link);
  ASSERT_TRUE(governor_.room().patches);
  EXPECT_LE(*governor_.room().patches, 16U);
  EXPECT_TRUE(governor_.room().features);
}

TEST_F(LinkGovernorTest, KnowsTheNewestFrameThatWasSent) {
  EXPECT_FALSE(governor_.newest_sent());
  governor_.sent(FrameId(7), at(0), 0, 0);
  EXPECT_EQ(governor_.newest_sent(), FrameId(7));
}

// A frame that waited in the agent itself, as for a busy processor, does not speak against the link.
TEST_F(LinkGovernorTest, TheAgentsOwnDelayIsNotTheLinks) {
  for (int i = 0; i < 5; ++i) play(0);
  for (int i = 0; i < 90; ++i, ++frame_) {
    const double now_s = frame_ / kRate_hz;
    if (governor_.due(static_cast<TimeNs>(now_s * 1e9))) {
      governor_.sent(FrameId(static_cast<std::uint32_t>(frame_)), at(now_s), 1.5, 0);
    }
    MapPatch patch;
    patch.after_frame = FrameId(static_cast<std::uint32_t>(frame_));
    patch.sent_ns = static_cast<TimeNs>(now_s * 1e9) + kMs;
    patch.received_ns = patch.sent_ns + kMs;
    patch.uplink_wait_s = 1.5F;
    governor_.heard({patch}, false, true, at(now_s));
  }
  EXPECT_FALSE(governor_.thins_frames());
}

}  // namespace
}  // namespace coslam::link_governor_test
