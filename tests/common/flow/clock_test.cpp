// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/flow/clock.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace coslam::clock_test {
namespace {

constexpr TimeNs kSecond_ns = 1'000'000'000;

TEST(Clock, UtcIsTheTimeOfDayWhereThatWasNotSet) {
  EXPECT_LT(std::abs(utc_now_ns() - time_of_day_ns()), kSecond_ns);
  EXPECT_EQ(clock_set_ns(), 0);
}

TEST(Clock, UtcGoesOnAsMonotonicTimeDoes) {
  const TimeNs utc_ns = utc_now_ns(), monotonic_ns = monotonic_now_ns();
  TimeNs last_ns = utc_ns;
  for (int i = 0; i < 1000; ++i) {
    const TimeNs now_ns = utc_now_ns();
    ASSERT_GE(now_ns, last_ns);
    last_ns = now_ns;
  }
  EXPECT_LT(std::abs((last_ns - utc_ns) - (monotonic_now_ns() - monotonic_ns)), kSecond_ns);
}

}  // namespace
}  // namespace coslam::clock_test
