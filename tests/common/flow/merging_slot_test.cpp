// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/flow/merging_slot.h"

#include <gtest/gtest.h>

#include <thread>

namespace coslam::merging_slot_test {
namespace {

struct Sum {
  long value = 0;
  int parts = 1;
  void update(const Sum& newer) {
    value += newer.value;
    parts += newer.parts;
  }
};

TEST(MergingSlot, WhatIsNotTakenIsMerged) {
  MergingSlot<Sum> slot;
  slot.put({1});
  slot.put({2});
  const auto taken = slot.take();
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->value, 3);
  EXPECT_EQ(taken->parts, 2);
  slot.put({5});
  EXPECT_EQ(slot.take()->value, 5) << "what was taken is gone";
}

TEST(MergingSlot, WhatIsInsideComesOutAfterTheEnd) {
  MergingSlot<Sum> slot;
  slot.put({1});
  slot.close();
  slot.put({2});
  EXPECT_EQ(slot.take()->value, 1);
  EXPECT_FALSE(slot.take());
}

TEST(MergingSlot, NothingIsLostBetweenThreads) {
  constexpr long kPuts = 20000;
  MergingSlot<Sum> slot;
  std::jthread writer([&] {
    for (long i = 0; i < kPuts; ++i) slot.put({1});
    slot.close();
  });
  long sum = 0;
  while (const auto taken = slot.take()) sum += taken->value;
  EXPECT_EQ(sum, kPuts);
}

}  // namespace
}  // namespace coslam::merging_slot_test
