// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/play_start.h"

#include <gtest/gtest.h>

namespace coslam::play_start_test {
namespace {

ServerStatus starts_at(TimeNs start_utc_ns) {
  ServerStatus status;
  status.started = true;
  status.start_utc_ns = start_utc_ns;
  return status;
}

TEST(PlayStartTest, AWordThatCameSoonIsEnough) {
  PlayStart start;
  const auto known = start.heard(starts_at(to_ns(100.0)), 0.03);
  ASSERT_TRUE(known);
  EXPECT_EQ(known->start_utc_ns, to_ns(100.0));
  EXPECT_EQ(known->clock_ahead_s, 0);
}

TEST(PlayStartTest, AWordThatWasLostAndSentAgainIsNoClockThatIsAhead) {
  PlayStart start;
  EXPECT_FALSE(start.heard(starts_at(to_ns(100.0)), 0.85));
  const auto known = start.heard(starts_at(to_ns(100.0)), 0.02);
  ASSERT_TRUE(known);
  EXPECT_EQ(known->start_utc_ns, to_ns(100.0));
}

TEST(PlayStartTest, AClockThatIsWrongIsWhenSeveralWordsSaySo) {
  for (const double ahead_s : {5.0, -5.0, 0.3}) {
    PlayStart start;
    EXPECT_FALSE(start.heard(starts_at(to_ns(100.0)), ahead_s + 0.8));
    EXPECT_FALSE(start.heard(starts_at(to_ns(100.0)), ahead_s));
    const auto known = start.heard(starts_at(to_ns(100.0)), ahead_s);
    ASSERT_TRUE(known);
    EXPECT_EQ(known->start_utc_ns, to_ns(100.0) + to_ns(ahead_s));
    EXPECT_EQ(known->clock_ahead_s, ahead_s);
  }
}

}  // namespace
}  // namespace coslam::play_start_test
