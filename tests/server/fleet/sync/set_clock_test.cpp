// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/sync/set_clock.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace coslam::set_clock_test {
namespace {

constexpr CameraId kA(0), kB(1);
constexpr TimeNs kMs = 1'000'000, kPeriod = 33 * kMs;

class SetClockTest : public testing::Test {
 protected:
  void join(CameraId camera, const std::string& name, Pacing pacing) {
    Hello hello;
    hello.agent = name;
    hello.rate_hz = 30;
    hello.pacing = pacing;
    sets_.add(camera, hello);
  }
  static CameraFrame frame(CameraId camera, int number) {
    CameraFrame f{camera, {}, {}, {}};
    f.frame.frame = FrameId(static_cast<std::uint32_t>(number));
    f.frame.capture_ns = number * kPeriod;
    return f;
  }
  SetClock::Pushed push(CameraId camera, int number) {
    CameraFrame f = frame(camera, number);
    const TimeNs now_ns = f.frame.capture_ns + 5 * kMs;
    EXPECT_TRUE(sets_.date(&f, now_ns));
    return sets_.push(std::move(f), now_ns);
  }
  std::optional<FrameSet> next(int number, std::size_t most = 100) {
    return sets_.next(number * kPeriod + 6 * kMs, most,
                      [this](const FrameSet& set) { left_out_.push_back(set.id.value); });
  }

  SetClock sets_{{}, 0};
  std::vector<std::uint32_t> left_out_;
};

TEST_F(SetClockTest, AFrameOfEachCameraMakesASet) {
  join(kA, "a", Pacing::kLockstep);
  join(kB, "b", Pacing::kLockstep);
  EXPECT_TRUE(push(kA, 0).in_time);
  EXPECT_FALSE(next(0));
  EXPECT_TRUE(push(kB, 0).in_time);
  const auto set = next(0);
  ASSERT_TRUE(set);
  EXPECT_EQ(set->frames.size(), 2U);
}

TEST_F(SetClockTest, NothingIsLeftOutOrDelayedInLockStep) {
  join(kA, "a", Pacing::kLockstep);
  for (int i = 0; i < 10; ++i) push(kA, i);
  EXPECT_TRUE(sets_.lockstep());
  EXPECT_EQ(sets_.wait_s(kA), 0);
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(next(10, 2)) << i;
  EXPECT_EQ(sets_.sets_left_out(), 0U);
}

TEST_F(SetClockTest, InRealTimeWhatIsTooMuchIsLeftOutAndCounted) {
  join(kA, "a", Pacing::kLive);
  for (int i = 0; i < 10; ++i) push(kA, i);
  ASSERT_TRUE(next(10, 3));
  EXPECT_EQ(left_out_.size(), 7U);
  EXPECT_EQ(sets_.sets_left_out(), 7U);
  EXPECT_TRUE(sets_.waiting());
  EXPECT_TRUE(sets_.next_waiting());
}

TEST_F(SetClockTest, OneInLockStepIsWaitedForHoweverLongItIsSilent) {
  join(kA, "a", Pacing::kLockstep);
  join(kB, "b", Pacing::kLockstep);
  push(kA, 0);
  sets_.set_silent(kB);
  EXPECT_FALSE(next(1000));
  sets_.finish(kB);
  EXPECT_TRUE(next(1000));
}

TEST_F(SetClockTest, AFrameOfBeforeTheLastSetIsLate) {
  join(kA, "a", Pacing::kLockstep);
  push(kA, 5);
  ASSERT_TRUE(next(5));
  EXPECT_FALSE(push(kA, 2).in_time);
  EXPECT_EQ(sets_.late(), 1U);
  EXPECT_EQ(sets_.past_ns(), 5 * kPeriod);
}

}  // namespace
}  // namespace coslam::set_clock_test
