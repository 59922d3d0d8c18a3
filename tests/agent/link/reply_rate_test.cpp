// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/link/reply_rate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <deque>

namespace coslam::reply_rate_test {
namespace {

constexpr double kPeriod_s = 0.1, kRound_s = 0.1;
constexpr double kFrameBytes = 1100;

// A link that carries so many bytes a second, one after the other, with frames ten times a second and replies that wait
// without end, beside what the middleware sends. The server answers each frame as it comes.
struct Link {
  double bytes_per_s = 0;
  double others_bytes_per_s = 0;
  double most_wait_s = 0, replies_bytes = 0;
  Instant now{};
  struct Sent {
    Instant at;
    double bytes = 0, replies_before = 0;
  };
  std::deque<Sent> queue{};  // a frame and what went before it
  double sent_bytes = 0, spare_bytes = 0;

  void play(ReplyRate& rate, double for_s) {
    for (double t_s = 0; t_s < for_s; t_s += kPeriod_s) {
      const double room = replies_bytes + rate.unanswered_bytes() - sent_bytes;
      const double replies = std::clamp(room, 0.0, rate.bytes_per_s() * kPeriod_s);
      sent_bytes += replies;
      queue.push_back({now, kFrameBytes + others_bytes_per_s * kPeriod_s + replies, sent_bytes});
      now += std::chrono::milliseconds(100);
      spare_bytes += bytes_per_s * kPeriod_s;
      for (; !queue.empty() && queue.front().bytes <= spare_bytes; queue.pop_front()) {
        spare_bytes -= queue.front().bytes;
        const double wait_s = std::chrono::duration<double>(now - queue.front().at).count() - kPeriod_s;
        most_wait_s = std::max(most_wait_s, wait_s);
        replies_bytes = queue.front().replies_before;
        rate.heard(wait_s, wait_s + kRound_s, true, queue.front().replies_before, now);
      }
      if (queue.empty()) spare_bytes = 0;
    }
  }
};

TEST(ReplyRateTest, ANarrowLinkKeepsItsQueueShort) {
  ReplyRate rate;
  Link link{.bytes_per_s = 32e3};
  link.play(rate, 6);  // what was sent before anything was heard
  const double before = link.replies_bytes;
  link.most_wait_s = 0;
  link.play(rate, 30);
  EXPECT_LT(link.most_wait_s, 0.8);
  EXPECT_GT((link.replies_bytes - before) / 30, 0.6 * (32e3 - 10 * kFrameBytes)) << "what frames leave is used";
}

TEST(ReplyRateTest, ANarrowLinkIsFoundWithoutALongQueue) {
  ReplyRate rate;
  Link link{.bytes_per_s = 32e3, .others_bytes_per_s = 12e3};
  link.play(rate, 6);
  EXPECT_LT(link.most_wait_s, 0.4);
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
  for (int i = 0; i < 100; ++i) rate.heard(0, 0.1, false, 0, now += std::chrono::milliseconds(33));
  EXPECT_EQ(rate.bytes_per_s(), before);
}

TEST(ReplyRateTest, NeverStops) {
  ReplyRate rate;
  Instant now{};
  for (int i = 0; i < 1000; ++i) rate.heard(5, 5, true, 0, now += std::chrono::milliseconds(33));
  EXPECT_GE(rate.bytes_per_s(), 4e3);
}

}  // namespace
}  // namespace coslam::reply_rate_test
