// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/flow/worker.h"

#include <gtest/gtest.h>
#include <pthread.h>

#include <array>
#include <atomic>
#include <stdexcept>

#include "common/base/log.h"
#include "common/flow/bounded_queue.h"

namespace coslam::worker_test {
namespace {

TEST(Worker, DestructorStopsAndJoins) {
  std::atomic<bool> ended{false};
  {
    const Worker worker("spin", [&](std::stop_token stop) {
      while (!stop.stop_requested()) std::this_thread::yield();
      ended = true;
    });
  }
  EXPECT_TRUE(ended);
}

TEST(Worker, StopCallbackClosesTheQueueItWaitsOn) {
  BoundedQueue<int> queue(1, QueuePolicy::kBlock);
  int sum = 0;
  {
    Worker worker("sum", [&](std::stop_token stop) {
      const std::stop_callback close(stop, [&] { queue.close(); });
      while (auto item = queue.pop()) sum += *item;
    });
    for (const int i : {1, 2, 3}) queue.push(i);
  }
  EXPECT_EQ(sum, 6) << "what was in the queue is still worked off";
}

TEST(Worker, JoinTwiceIsFine) {
  Worker worker("once", [](std::stop_token) {});
  worker.join();
  worker.join();
}

TEST(Worker, LongNamesAreCut) {
  std::array<char, 32> name{};
  Worker worker("a-name-longer-than-the-kernel-takes",
                [&](std::stop_token) { pthread_getname_np(pthread_self(), name.data(), name.size()); });
  worker.join();
  EXPECT_STREQ(name.data(), "a-name-longer-t");
}

TEST(WorkerDeathTest, AnEscapedExceptionEndsTheProcess) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_DEATH(
      {
        init_log("test");  // to stderr
        Worker worker("broken", [](std::stop_token) { throw std::runtime_error("out of cheese"); });
        worker.join();
      },
      "thread 'broken' failed: out of cheese");
}

}  // namespace
}  // namespace coslam::worker_test
