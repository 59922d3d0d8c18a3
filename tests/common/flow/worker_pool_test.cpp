// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/flow/worker_pool.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <barrier>
#include <mutex>
#include <numeric>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

namespace coslam::worker_pool_test {
namespace {

class WorkerPoolTest : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Threads, WorkerPoolTest, testing::Values(1, 2, 5));

TEST_P(WorkerPoolTest, DoesEachPartOnce) {
  WorkerPool pool("test", GetParam());
  for (std::size_t n = 0; n < 200; ++n) {
    std::vector<int> done(n, 0);
    pool.each(n, [&](std::size_t i) { ++done[i]; });
    EXPECT_EQ(std::accumulate(done.begin(), done.end(), 0), static_cast<int>(n));
    EXPECT_EQ(std::ranges::count(done, 1), static_cast<std::ptrdiff_t>(n));
  }
}

TEST_P(WorkerPoolTest, ThrowsWhatAPartThrew) {
  WorkerPool pool("test", GetParam());
  std::atomic<int> done = 0;
  const auto work = [&](std::size_t i) {
    if (i == 3) throw std::runtime_error("the fourth");
    ++done;
  };
  EXPECT_THROW(pool.each(20, work), std::runtime_error);
  done = 0;
  pool.each(3, work);
  EXPECT_EQ(done, 3) << "it goes on";
}

TEST(WorkerPool, HasSoManyThreadsWithTheCallers) {
  WorkerPool pool("test", 3);
  std::mutex mutex;
  std::set<std::thread::id> threads;
  std::barrier together(3);
  pool.each(3, [&](std::size_t) {
    together.arrive_and_wait();
    const std::lock_guard lock(mutex);
    threads.insert(std::this_thread::get_id());
  });
  EXPECT_EQ(threads.size(), 3U);
  EXPECT_EQ(pool.at_once(), 3U);
  EXPECT_TRUE(threads.contains(std::this_thread::get_id()));
}

}  // namespace
}  // namespace coslam::worker_pool_test
