// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/flow/latest_slot.h"

#include <gtest/gtest.h>

#include <thread>

namespace coslam::latest_slot_test {
namespace {

using namespace std::chrono_literals;

TEST(LatestSlot, KeepsTheNewestAndCountsTheRest) {
  LatestSlot<int> slot;
  EXPECT_EQ(slot.try_take(), std::nullopt);
  for (const int i : {1, 2, 3}) slot.put(i);
  EXPECT_EQ(slot.try_take(), 3);
  EXPECT_EQ(slot.try_take(), std::nullopt);
  EXPECT_EQ(slot.overwritten(), 2u);
}

TEST(LatestSlot, TakerSeesTheLastValueOfAFasterWriter) {
  constexpr int kLast = 50000;
  LatestSlot<int> slot;
  std::jthread writer([&] {
    for (int i = 1; i <= kLast; ++i) slot.put(i);
  });
  int seen = 0;
  while (seen < kLast) {
    const auto value = slot.take();
    ASSERT_TRUE(value);
    EXPECT_GT(*value, seen) << "never an older one";
    seen = *value;
  }
}

TEST(LatestSlot, CloseWakesAWaitingTaker) {
  LatestSlot<int> slot;
  std::jthread closer([&] { slot.close(); });
  EXPECT_EQ(slot.take(), std::nullopt);
  slot.put(1);
  EXPECT_EQ(slot.try_take(), std::nullopt) << "closed for good";
}

TEST(LatestSlot, TakeForEndsAtTheTimeout) {
  LatestSlot<int> slot;
  EXPECT_EQ(slot.take_for(1ms), std::nullopt);
  slot.put(4);
  EXPECT_EQ(slot.take_for(1ms), 4);
}

}  // namespace
}  // namespace coslam::latest_slot_test
