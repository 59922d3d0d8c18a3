// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/sync/clock_estimate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace coslam::clock_estimate_test {
namespace {

constexpr TimeNs kUtc_ns = 1'700'000'000'000'000'000;

// An agent whose clock is off by some seconds, and drifts, at the far end of a link with random delays.
class ClockEstimateTest : public testing::Test {
 protected:
  TimeNs agent_clock_ns(double server_s) const { return kUtc_ns + to_ns(server_s + offset_s_ + drift_ * server_s); }
  double delay_s() { return least_delay_s_ + std::exponential_distribution<>(1 / jitter_s_)(random_); }
  void exchange(double at_s) {
    const double there_s = at_s + delay_s(), reply_s = there_s + 0.02, back_s = reply_s + delay_s();
    clock_.add({to_ns(at_s), agent_clock_ns(there_s), agent_clock_ns(reply_s), to_ns(back_s)});
  }
  double error_s(double at_s) const {
    return *clock_.offset_s(to_ns(at_s)) - to_seconds(agent_clock_ns(at_s) - to_ns(at_s));
  }

  double offset_s_ = 0.3, drift_ = 0, least_delay_s_ = 0.001, jitter_s_ = 0.002;
  std::mt19937 random_{1};
  ClockEstimate clock_;
};

TEST_F(ClockEstimateTest, SaysNothingBeforeThreeExchanges) {
  exchange(0);
  exchange(1);
  EXPECT_FALSE(clock_.offset_s(to_ns(1)));
  exchange(2);
  EXPECT_TRUE(clock_.offset_s(to_ns(2)));
}

TEST_F(ClockEstimateTest, IsWithinTwoMillisecondsAfterTenSeconds) {
  for (const double offset_s : {0.3, -0.3, 5.0, -3600.0}) {
    clock_ = {};
    offset_s_ = offset_s;
    for (int i = 0; i < 10; ++i) exchange(i);
    EXPECT_LT(std::abs(error_s(10)), 0.002) << offset_s;
  }
}

TEST_F(ClockEstimateTest, BearsASlowLinkThatJitters) {
  least_delay_s_ = 0.1;
  jitter_s_ = 0.05;
  for (int i = 0; i < 30; ++i) exchange(i);
  EXPECT_LT(std::abs(error_s(30)), 0.02) << "half of the round trip is 150 ms";
}

TEST_F(ClockEstimateTest, FollowsADriftOf500Ppm) {
  drift_ = 500e-6;
  double worst_s = 0;
  for (int i = 0; i < 300; ++i) {
    exchange(i);
    if (i >= 10) worst_s = std::max(worst_s, std::abs(error_s(i + 1)));
  }
  EXPECT_LT(worst_s, 0.003);
}

TEST_F(ClockEstimateTest, BelievesASetClockAtTheSecondExchangeAndNotAStray) {
  for (int i = 0; i < 20; ++i) exchange(i);
  offset_s_ = 5;
  exchange(20);
  EXPECT_FALSE(clock_.offset_s(to_ns(20))) << "one or the other";
  offset_s_ = 0.3;
  exchange(21);
  EXPECT_LT(std::abs(error_s(21)), 0.002) << "a stray";
  offset_s_ = 5;
  for (int i = 22; i < 26; ++i) exchange(i);
  EXPECT_LT(std::abs(error_s(26)), 0.003);
}

TEST_F(ClockEstimateTest, LeavesNonsenseOut) {
  for (int i = 0; i < 10; ++i) exchange(i);
  const double before_s = error_s(10);
  clock_.add({to_ns(11), kUtc_ns, kUtc_ns + to_ns(100), to_ns(11.01)});  // held longer than it was under way
  clock_.add({to_ns(12), kUtc_ns, kUtc_ns - 1, to_ns(12.01)});
  clock_.add({to_ns(13), kUtc_ns, kUtc_ns, to_ns(12.9)});
  constexpr TimeNs kLeast = std::numeric_limits<TimeNs>::min(), kMost = std::numeric_limits<TimeNs>::max();
  clock_.add({to_ns(14), kLeast, kMost, to_ns(14.01)});
  clock_.add({kLeast, kUtc_ns, kUtc_ns, to_ns(14.01)});
  EXPECT_EQ(error_s(10), before_s);
}

}  // namespace
}  // namespace coslam::clock_estimate_test
