// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/link/reply_rate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>

namespace coslam {
namespace {

constexpr double kPeriod_s = 0.1;
constexpr double kFrameBytes = 1100;

// A link that carries so many bytes a second, with frames ten times a second and replies that wait without end, beside
// what the middleware sends.
struct Link {
  double bytes_per_s = 0;
  double others_bytes_per_s = 0;
  double queue_bytes = 0, most_wait_s = 0, replies_bytes = 0;
  Instant now{};

  void play(ReplyRate& rate, double for_s) {
    for (double t_s = 0; t_s < for_s; t_s += kPeriod_s) {
      now += std::chrono::milliseconds(100);
      queue_bytes = std::max(0.0, queue_bytes - bytes_per_s * kPeriod_s);
      const double wait_s = queue_bytes / bytes_per_s;
      most_wait_s = std::max(most_wait_s, wait_s);
      rate.heard(wait_s, true, now);
      queue_bytes += kFrameBytes + (rate.bytes_per_s() + others_bytes_per_s) * kPeriod_s;
      replies_bytes += rate.bytes_per_s() * kPeriod_s;
    }
  }
};

TEST(ReplyRateTest, ANarrowLinkKeepsItsQueueShort) {
  ReplyRate rate;
  Link link{.bytes_per_s = 32e3};
  link.play(rate, 6);  // what was sent before anything was heard
  link.most_wait_s = link.replies_bytes = 0;
  link.play(rate, 30);
  EXPECT_LT(link.most_wait_s, 0.8);
  EXPECT_GT(link.replies_bytes / 30, 0.6 * (32e3 - 10 * kFrameBytes)) << "what frames leave is used";
}

TEST(ReplyRateTest, ANarrowLinkIsFoundWithoutALongQueue) {
  ReplyRate rate;
  Link link{.bytes_per_s = 32e3, .others_bytes_per_s = 12e3};
  link.play(rate, 6);
  EXPECT_LT(link.most_wait_s, 0.5);
}

TEST(ReplyRateTest, AWideLinkIsUsedAtOnce) {
  ReplyRate rate;
  Link link{.bytes_per_s = 10e6};
  link.play(rate, 1);
  EXPECT_GT(link.replies_bytes, 25e3);
  link.play(rate, 3);
  link.play(rate, 10);
  EXPECT_GT(rate.bytes_per_s(), 1e6);
}

TEST(ReplyRateTest, NothingIsTriedWhileNothingWaits) {
  ReplyRate rate;
  const double before = rate.bytes_per_s();
  Instant now{};
  for (int i = 0; i < 100; ++i) rate.heard(0, false, now += std::chrono::milliseconds(33));
  EXPECT_EQ(rate.bytes_per_s(), before);
}

TEST(ReplyRateTest, NeverStops) {
  ReplyRate rate;
  Instant now{};
  for (int i = 0; i < 1000; ++i) rate.heard(5, true, now += std::chrono::milliseconds(33));
  EXPECT_GE(rate.bytes_per_s(), 4e3);
}

}  // namespace
}  // namespace coslam
