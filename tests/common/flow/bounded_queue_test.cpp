// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/flow/bounded_queue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <thread>
#include <vector>

namespace coslam::bounded_queue_test {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;

std::vector<int> drain(BoundedQueue<int>& queue) {
  std::vector<int> items;
  while (auto item = queue.try_pop()) items.push_back(*item);
  return items;
}

TEST(BoundedQueue, KeepsOrder) {
  BoundedQueue<int> queue(3, QueuePolicy::kRefuse);
  for (const int i : {1, 2, 3}) EXPECT_TRUE(queue.push(i));
  EXPECT_THAT(drain(queue), ElementsAre(1, 2, 3));
}

TEST(BoundedQueue, DropOldestKeepsTheNewestAndCounts) {
  BoundedQueue<int> queue(2, QueuePolicy::kDropOldest);
  for (const int i : {1, 2, 3, 4, 5}) EXPECT_TRUE(queue.push(i));
  EXPECT_EQ(queue.counts().dropped, 3u);
  EXPECT_EQ(queue.counts().peak, 2u);
  EXPECT_THAT(drain(queue), ElementsAre(4, 5));
}

TEST(BoundedQueue, DropOldestSparesWhatMustNotBeLost) {
  BoundedQueue<int> queue(3, QueuePolicy::kDropOldest, [](int i) { return i >= 10; });
  for (const int i : {1, 10, 2, 11}) EXPECT_TRUE(queue.push(i));
  EXPECT_THAT(drain(queue), ElementsAre(1, 2, 11));
  for (const int i : {1, 2, 3}) EXPECT_TRUE(queue.push(i));
  EXPECT_FALSE(queue.push(10)) << "nothing can be dropped";
  EXPECT_EQ(queue.counts().refused, 1u);
  EXPECT_THAT(drain(queue), ElementsAre(1, 2, 3));
}

TEST(BoundedQueue, RefuseLeavesTheQueueAsItIs) {
  BoundedQueue<int> queue(2, QueuePolicy::kRefuse);
  queue.push(1);
  queue.push(2);
  EXPECT_FALSE(queue.push(3));
  EXPECT_EQ(queue.counts().refused, 1u);
  EXPECT_EQ(queue.counts().depth, 2u);
  EXPECT_THAT(drain(queue), ElementsAre(1, 2));
}

TEST(BoundedQueue, BlockLosesNothingBetweenThreads) {
  constexpr int kCount = 20000;
  BoundedQueue<int> queue(4, QueuePolicy::kBlock);
  std::jthread producer([&] {
    for (int i = 0; i < kCount; ++i) queue.push(i);
    queue.close();
  });
  int expected = 0;
  while (auto item = queue.pop()) EXPECT_EQ(*item, expected++);
  EXPECT_EQ(expected, kCount);
  EXPECT_LE(queue.counts().peak, 4u);
}

TEST(BoundedQueue, ManyProducersAndConsumersShareAllItems) {
  constexpr int kEach = 5000;
  BoundedQueue<int> queue(8, QueuePolicy::kBlock);
  std::atomic<long> sum{0};
  {
    std::vector<std::jthread> consumers;
    for (int c = 0; c < 3; ++c) {
      consumers.emplace_back([&] {
        while (auto item = queue.pop()) sum += *item;
      });
    }
    {
      std::vector<std::jthread> producers;
      for (int p = 0; p < 3; ++p) {
        producers.emplace_back([&] {
          for (int i = 1; i <= kEach; ++i) queue.push(i);
        });
      }
    }
    queue.close();
  }
  EXPECT_EQ(sum.load(), 3L * kEach * (kEach + 1) / 2);
}

TEST(BoundedQueue, CloseWakesAWaitingConsumer) {
  BoundedQueue<int> queue(1, QueuePolicy::kBlock);
  std::jthread closer([&] { queue.close(); });
  EXPECT_EQ(queue.pop(), std::nullopt);
}

TEST(BoundedQueue, CloseWakesAWaitingProducer) {
  BoundedQueue<int> queue(1, QueuePolicy::kBlock);
  queue.push(1);
  std::jthread closer([&] { queue.close(); });
  EXPECT_FALSE(queue.push(2));
  EXPECT_THAT(drain(queue), ElementsAre(1)) << "what was inside stays available";
}

TEST(BoundedQueue, PopForEndsAtTheTimeout) {
  BoundedQueue<int> queue(1, QueuePolicy::kBlock);
  EXPECT_EQ(queue.pop_for(1ms), std::nullopt);
  queue.push(7);
  EXPECT_EQ(queue.pop_for(1ms), 7);
}

TEST(BoundedQueue, CarriesMoveOnlyItems) {
  BoundedQueue<std::unique_ptr<int>> queue(1, QueuePolicy::kRefuse);
  queue.push(std::make_unique<int>(5));
  EXPECT_EQ(**queue.pop(), 5);
}

}  // namespace
}  // namespace coslam::bounded_queue_test
