// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/link/send_rate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>

namespace coslam::send_rate_test {
namespace {

using std::chrono::duration_cast;

constexpr double kPeriod_s = 1 / 30.0;

Instant at(double s) { return Instant(duration_cast<Instant::duration>(std::chrono::duration<double>(100 + s))); }

// A link that carries so many frames a second, with a queue of two seconds. The server says how long each waited.
class Link {
 public:
  explicit Link(double frames_a_second) : per_frame_s_(1 / frames_a_second) {}
  void send(double now_s) {
    const double start_s = std::max(now_s, free_s_);
    if (start_s - now_s > 2) return;
    free_s_ = start_s + per_frame_s_;
    under_way_.emplace_back(free_s_, start_s - now_s);
  }
  void answer(SendRate& rate, double now_s) {
    rate.tick(at(now_s));
    for (; !under_way_.empty() && under_way_.front().first <= now_s; under_way_.pop_front()) {
      rate.heard(under_way_.front().second, 1e6, false, at(now_s));  // whatever the clocks say
    }
  }
  double waits_s(double now_s) const { return std::max(0.0, free_s_ - now_s); }

 private:
  double per_frame_s_, free_s_ = 0;
  std::deque<std::pair<double, double>> under_way_;
};

struct Played {
  int sent = 0;
  double longest_wait_s = 0;
};

Played play(SendRate& rate, Link& link, double from_s, double to_s) {
  Played out;
  for (int i = static_cast<int>(from_s / kPeriod_s); i * kPeriod_s < to_s; ++i) {
    const double now_s = i * kPeriod_s;
    link.answer(rate, now_s);
    if (!rate.due(to_ns(now_s))) continue;
    link.send(now_s);
    ++out.sent;
    out.longest_wait_s = std::max(out.longest_wait_s, link.waits_s(now_s));
  }
  return out;
}

TEST(SendRate, ATryEndsWhenAFewFramesWaited) {
  SendRate rate(30);
  double now_s = 0;
  for (; rate.narrow(); now_s += kPeriod_s) rate.heard(0, 0.01, false, at(now_s));
  const double tried_s = now_s;
  for (; !rate.narrow() && now_s < tried_s + 2; now_s += kPeriod_s) rate.heard(now_s - tried_s, 0.01, false, at(now_s));
  EXPECT_LT(now_s - tried_s, 0.45);
  EXPECT_EQ(rate.one_in(), 2);
}

// What is late on the way down may have waited for a message that was lost.
TEST(SendRate, ATryGoesOnWhenAFewAnswersWaited) {
  SendRate rate(30);
  for (int i = 0; i < 900; ++i) rate.heard(i % 3 == 0 ? 0.0 : 0.2, i % 10 < 8 ? 0.5 : 0.01, false, at(i * kPeriod_s));
  EXPECT_EQ(rate.one_in(), 1);
}

TEST(SendRate, EverythingGoesOnAGoodLink) {
  SendRate rate(30);
  Link link(1000);
  EXPECT_GE(play(rate, link, 0, 30).sent, 880) << "all, half a second after half of them got through";
  EXPECT_FALSE(rate.narrow());
}

TEST(SendRate, AClockThatIsSetIsNoFullLink) {
  for (const double set_s : {0.7, 5.0, 3600.0, -5.0}) {
    SendRate rate(30);
    double now_s = 0;
    const auto hear = [&](double until_s, double downlink_s) {
      for (; now_s < until_s; now_s += kPeriod_s) rate.heard(0, downlink_s, false, at(now_s));
    };
    hear(5, 0.01);
    ASSERT_FALSE(rate.narrow());
    hear(20, 0.01 + set_s);
    EXPECT_FALSE(rate.narrow()) << set_s;
    // A queue of words that grows is one all the same.
    for (double wait_s = 0; wait_s < 2; wait_s += 0.02, now_s += kPeriod_s) {
      rate.heard(0, 0.01 + set_s + wait_s, false, at(now_s));
    }
    EXPECT_TRUE(rate.narrow()) << set_s;
  }
}

TEST(SendRate, GivesWayOnANarrowLinkAndKeepsTenASecond) {
  SendRate rate(30);
  Link link(13);
  play(rate, link, 0, 10);
  const Played later = play(rate, link, 10, 70);
  EXPECT_TRUE(rate.narrow());
  EXPECT_LT(later.longest_wait_s, 1.9) << "no queue grows";
  EXPECT_GE(later.sent, 60 * 10);
  EXPECT_LE(later.sent, 60 * 14);
}

TEST(SendRate, GivesWayWhenNothingComesThrough) {
  SendRate rate(30);
  for (int i = 0; i < 300; ++i) rate.tick(at(i * kPeriod_s));
  EXPECT_EQ(rate.one_in(), 3);
}

TEST(SendRate, ALinkThatWasCutIsAsItWasBefore) {
  SendRate rate(30);
  for (int i = 0; i < 60; ++i) rate.heard(0, 0.01, false, at(i * kPeriod_s));
  for (int i = 60; i < 400; ++i) rate.tick(at(i * kPeriod_s));
  EXPECT_TRUE(rate.narrow());
  rate.heard(0, 0.01, false, at(400 * kPeriod_s));
  EXPECT_FALSE(rate.narrow());
}

TEST(SendRate, TheWayDownCountsToo) {
  SendRate rate(30);
  for (int i = 0; i < 600; ++i) rate.heard(0, -77 + std::clamp(0.02 * (i - 60), 0.01, 0.9), false, at(i * kPeriod_s));
  EXPECT_EQ(rate.one_in(), 3);
}

TEST(SendRate, AStallIsNoNarrowLink) {
  SendRate rate(30);
  for (int i = 0; i < 600; ++i) rate.heard(i > 300 && i < 312 ? 2 : 0.01, 0.01, false, at(i * kPeriod_s));
  EXPECT_FALSE(rate.narrow());
}

// Lost and sent again: late by nine tenths of a second, while what was not lost comes at once.
TEST(SendRate, LostMessagesAreNoNarrowLink) {
  SendRate rate(30);
  for (int i = 0; i < 900; ++i) {
    rate.heard(0, i % 7 < 2 ? 0.9 : 0.01, false, at(0.1 * i));
    if (i >= 10) {
      ASSERT_EQ(rate.one_in(), 1) << i;
    }
  }
}

TEST(SendRate, OneLateMessageAtFirstIsNoNarrowLink) {
  SendRate rate(30);
  rate.heard(0.9, 0.01, false, at(0));
  for (int i = 1; i < 30; ++i) rate.heard(0, 0.01, false, at(i * kPeriod_s));
  EXPECT_EQ(rate.one_in(), 1);
}

TEST(SendRate, ANarrowLinkIsKnownAtFirst) {
  SendRate rate(30);
  for (int i = 0; i < 60; ++i) rate.heard(0.9, 0.01, false, at(i * kPeriod_s));
  EXPECT_TRUE(rate.narrow());
}

// Two agents that both send one frame in three send those of the same instants, whenever each began to.
TEST(SendRate, AgentsThinAlike) {
  SendRate one(30), other(30);
  for (int i = 0; i < 600; ++i) {
    one.heard(i < 40 ? 0 : 2, 0, false, at(i * kPeriod_s));
    other.heard(i < 141 ? 0 : 2, 0, false, at(i * kPeriod_s));
    const bool first = one.due(to_ns(7.003 + i * kPeriod_s)), second = other.due(to_ns(7 + i * kPeriod_s));
    EXPECT_TRUE(i <= 570 || first == second) << i;
  }
  EXPECT_EQ(one.one_in(), 3);
  EXPECT_EQ(other.one_in(), 3);
}

TEST(SendRate, NeverLessThanTenASecond) {
  SendRate rate(30);
  Link link(2);
  EXPECT_GE(play(rate, link, 0, 60).sent, 8 * 60) << "but for the pauses";
  EXPECT_EQ(rate.one_in(), 3);
}

TEST(SendRate, ComesBackWhenTheLinkDoes) {
  SendRate rate(30);
  Link narrow(12), good(1000);
  play(rate, narrow, 0, 20);
  ASSERT_TRUE(rate.narrow());
  play(rate, good, 20, 160);
  EXPECT_FALSE(rate.narrow());
}

TEST(SendRate, ASlowCameraSendsAll) {
  SendRate rate(10);
  Link link(2);
  EXPECT_EQ(play(rate, link, 0, 10).sent, 300);
}

TEST(SendRate, TriesNoMoreWhileRepliesWait) {
  SendRate rate(30);
  for (int i = 0; i < 300; ++i) rate.heard(0.01, 0.01, true, at(i * kPeriod_s));
  EXPECT_TRUE(rate.narrow());
  for (int i = 300; i < 330; ++i) rate.heard(0.01, 0.01, false, at(i * kPeriod_s));
  EXPECT_FALSE(rate.narrow());
}

}  // namespace
}  // namespace coslam::send_rate_test
