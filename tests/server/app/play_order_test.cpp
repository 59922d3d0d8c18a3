// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/app/play_order.h"

#include <gtest/gtest.h>

namespace coslam::play_order_test {
namespace {

class PlayOrderTest : public testing::Test {
 protected:
  // When it is ordered, from now on; empty: not within 100 s.
  std::optional<double> ordered_after_s() {
    for (double s = 0; s < 100; s += 0.1) {
      if (order_.due(now_ns_ + to_ns(s))) return s;
    }
    return std::nullopt;
  }
  void pass(double s) { now_ns_ += to_ns(s); }

  TimeNs now_ns_ = to_ns(1000.0);
  PlayOrder order_;
};

TEST_F(PlayOrderTest, WaitsUntilNobodyHasJoinedForAWhile) {
  EXPECT_FALSE(ordered_after_s()) << "nobody is here";
  order_.joined(now_ns_);
  pass(2);
  EXPECT_FALSE(order_.due(now_ns_));
  order_.joined(now_ns_);
  pass(2);
  EXPECT_FALSE(order_.due(now_ns_)) << "the second one came but 2 s ago";
  EXPECT_NEAR(ordered_after_s().value_or(0), PlayOrder::kGather_s - 2, 0.15);
  EXPECT_TRUE(order_.ordered());
  EXPECT_FALSE(ordered_after_s()) << "once";
}

TEST_F(PlayOrderTest, WhoJoinsLaterJoinsInWhatIsPlayed) {
  order_.joined(now_ns_);
  ASSERT_TRUE(ordered_after_s());
  order_.plays();
  pass(60);
  order_.joined(now_ns_);
  EXPECT_TRUE(order_.ordered());
}

TEST_F(PlayOrderTest, ARecordingBesideCamerasBeginsAtItsBeginning) {
  order_.joined(now_ns_);  // a camera
  ASSERT_TRUE(ordered_after_s());
  pass(60);
  order_.joined(now_ns_);
  EXPECT_FALSE(order_.ordered());
  EXPECT_NEAR(ordered_after_s().value_or(0), PlayOrder::kGather_s, 0.15);
}

}  // namespace
}  // namespace coslam::play_order_test
