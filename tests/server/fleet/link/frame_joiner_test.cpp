// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/link/frame_joiner.h"

#include <gtest/gtest.h>

namespace coslam::frame_joiner_test {
namespace {

using namespace std::chrono_literals;

TrackFrame frame(std::uint32_t number, std::uint16_t patches = 0, bool descriptors = false) {
  TrackFrame f;
  f.frame = FrameId(number);
  f.patches_sent = patches;
  f.descriptors_sent = descriptors ? DescriptorsSent::kWithFrame : DescriptorsSent::kNone;
  return f;
}

PatchReply patches(std::uint32_t number) { return {"cam0", RunId(1), FrameId(number), {}}; }
DescriptorReply descriptors(std::uint32_t number) { return {"cam0", RunId(1), FrameId(number), {}, {}}; }

class FrameJoinerTest : public testing::Test {
 protected:
  // Number of the next frame, or -1.
  int pop(FrameJoiner& joiner) {
    last_ = joiner.pop(now_);
    return last_ ? static_cast<int>(last_->frame.frame.value) : -1;
  }
  const JoinedFrame& last() const { return *last_; }

  Instant now_{};
  FrameJoiner lockstep_{Pacing::kLockstep};
  FrameJoiner live_{Pacing::kLive};

 private:
  std::optional<JoinedFrame> last_;
};

TEST_F(FrameJoinerTest, AFrameThatAnnouncesNothingGoesAtOnce) {
  live_.add(frame(0), now_);
  EXPECT_EQ(pop(live_), 0);
  EXPECT_EQ(pop(live_), -1);
}

TEST_F(FrameJoinerTest, SaysWhenAFrameArrivedThatWaited) {
  const Instant arrived = now_ += 1s;
  live_.add(frame(0, 1), now_);
  now_ += FrameJoiner::kPatience;
  ASSERT_EQ(pop(live_), 0);
  EXPECT_EQ(last().arrived, arrived);
}

// Live: a frame after a gap goes at once while frames come in order, and waits for the one before where they do not.
TEST_F(FrameJoinerTest, WaitsForFramesThatAreOvertaken) {
  live_.add(frame(0), now_);
  live_.add(frame(2), now_);
  EXPECT_EQ(pop(live_), 0);
  EXPECT_EQ(pop(live_), 2) << "frames get lost";
  now_ += 50ms;
  EXPECT_EQ(live_.add(frame(1), now_), Rejection::kDuplicate) << "too late this time";
  live_.add(frame(4), now_);
  EXPECT_EQ(pop(live_), -1);
  now_ += 40ms;
  live_.add(frame(3), now_);
  EXPECT_EQ(pop(live_), 3);
  EXPECT_EQ(pop(live_), 4);
  live_.add(frame(6), now_);
  EXPECT_EQ(pop(live_), -1);
  now_ += 61ms;
  EXPECT_EQ(pop(live_), 6) << "that one is lost";
}

TEST_F(FrameJoinerTest, ForgetsThatFramesWereOvertaken) {
  live_.add(frame(1), now_);
  EXPECT_EQ(pop(live_), 1);
  now_ += 10s;
  live_.add(frame(0), now_);  // a quarter of a second is waited at most
  for (std::uint32_t i = 2; i < 1500; ++i) {
    live_.add(frame(i), now_);
    pop(live_);
  }
  live_.add(frame(1501), now_);
  now_ += 13ms;
  EXPECT_EQ(pop(live_), 1501);
}

TEST_F(FrameJoinerTest, LockstepWaitsForBothReplies) {
  lockstep_.add(frame(7, 3, true), now_);
  now_ += 1h;
  EXPECT_EQ(pop(lockstep_), -1);
  lockstep_.add(patches(7));
  EXPECT_EQ(pop(lockstep_), -1);
  lockstep_.add(descriptors(7));
  ASSERT_EQ(pop(lockstep_), 7);
  EXPECT_TRUE(last().patches && last().descriptors);
}

TEST_F(FrameJoinerTest, RepliesMayComeFirst) {
  lockstep_.add(descriptors(7));
  lockstep_.add(patches(7));
  EXPECT_EQ(pop(lockstep_), -1);
  lockstep_.add(frame(7, 3, true), now_);
  ASSERT_EQ(pop(lockstep_), 7);
  EXPECT_TRUE(last().patches && last().descriptors);
}

TEST_F(FrameJoinerTest, AReplyInPartsIsOne) {
  lockstep_.add(frame(7, 3, true), now_);
  lockstep_.add(patches(7));
  for (const std::uint16_t number : {2, 0}) {
    DescriptorReply part = descriptors(7);
    part.part = {number, 3};
    lockstep_.add(part);
    EXPECT_EQ(pop(lockstep_), -1);
  }
  DescriptorReply last_part = descriptors(7);
  last_part.part = {1, 3};
  lockstep_.add(last_part);
  ASSERT_EQ(pop(lockstep_), 7);
  EXPECT_TRUE(last().patches && last().descriptors);
}

TEST_F(FrameJoinerTest, LiveWaitsForPatienceOnly) {
  live_.add(frame(7, 3), now_);
  now_ += FrameJoiner::kPatience - 1ms;
  EXPECT_EQ(pop(live_), -1);
  now_ += 1ms;
  ASSERT_EQ(pop(live_), 7);
  EXPECT_FALSE(last().patches);
}

TEST_F(FrameJoinerTest, ALateReplyRidesWithTheNextFrame) {
  live_.add(frame(7, 3), now_);
  now_ += FrameJoiner::kPatience;
  ASSERT_EQ(pop(live_), 7);
  EXPECT_EQ(live_.add(patches(7)), std::nullopt);
  live_.add(frame(8), now_);
  ASSERT_EQ(pop(live_), 8);
  ASSERT_TRUE(last().patches);
  EXPECT_EQ(last().patches->frame, FrameId(7));
  EXPECT_EQ(live_.late_replies(), 1u);
}

TEST_F(FrameJoinerTest, AFramesOwnReplyGoesBeforeALateOne) {
  live_.add(frame(7, 3), now_);
  now_ += FrameJoiner::kPatience;
  pop(live_);
  live_.add(frame(8, 2), now_);
  live_.add(patches(7));
  live_.add(patches(8));
  ASSERT_EQ(pop(live_), 8);
  EXPECT_EQ(last().patches->frame, FrameId(8));
  live_.add(frame(9), now_);
  ASSERT_EQ(pop(live_), 9);
  EXPECT_EQ(last().patches->frame, FrameId(7));
}

TEST_F(FrameJoinerTest, AReplyWhoseFrameWasLostIsStillUsed) {
  live_.add(patches(7));
  live_.add(frame(8), now_);
  ASSERT_EQ(pop(live_), 8);
  EXPECT_EQ(last().patches->frame, FrameId(7));
}

TEST_F(FrameJoinerTest, AReplyDoesNotRideWithAnEarlierFrame) {
  live_.add(patches(9));
  live_.add(frame(8), now_);
  ASSERT_EQ(pop(live_), 8);
  EXPECT_FALSE(last().patches);
}

TEST_F(FrameJoinerTest, FramesBehindAWaitingOneKeepTheirOrder) {
  live_.add(frame(1, 3), now_);
  live_.add(frame(2), now_);
  EXPECT_EQ(pop(live_), -1);
  live_.add(patches(1));
  EXPECT_EQ(pop(live_), 1);
  EXPECT_EQ(pop(live_), 2);
}

TEST_F(FrameJoinerTest, FramesThatOvertookEachOtherAreSorted) {
  live_.add(frame(3, 1), now_);
  live_.add(frame(2, 1), now_);
  live_.add(patches(2));
  live_.add(patches(3));
  EXPECT_EQ(pop(live_), 2);
  EXPECT_EQ(pop(live_), 3);
}

TEST_F(FrameJoinerTest, NothingComesTwice) {
  EXPECT_EQ(lockstep_.add(frame(1, 2), now_), std::nullopt);
  EXPECT_EQ(lockstep_.add(frame(1, 2), now_), Rejection::kDuplicate) << "while it waits";
  EXPECT_EQ(lockstep_.add(patches(1)), std::nullopt);
  EXPECT_EQ(lockstep_.add(patches(1)), Rejection::kDuplicate);
  EXPECT_EQ(pop(lockstep_), 1);
  EXPECT_EQ(lockstep_.add(frame(1, 2), now_), Rejection::kDuplicate) << "after it went";
  EXPECT_EQ(lockstep_.add(frame(0), now_), Rejection::kDuplicate) << "older";
  EXPECT_EQ(lockstep_.add(patches(1)), Rejection::kDuplicate);
  EXPECT_EQ(pop(lockstep_), -1);
}

TEST_F(FrameJoinerTest, AFloodIsBounded) {
  int taken = 0;
  for (std::uint32_t i = 0; i < 1000; ++i) taken += lockstep_.add(frame(i, 1), now_) ? 0 : 1;
  EXPECT_EQ(taken, 64);
  int overflows = 0;
  for (std::uint32_t i = 0; i < 100; ++i) overflows += live_.add(patches(i)) == Rejection::kOverflow ? 1 : 0;
  EXPECT_EQ(overflows, 84);
}

}  // namespace
}  // namespace coslam::frame_joiner_test
