// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/keep/store/saver.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>

#include "common/base/error.h"
#include "tests/support/temp_folder.h"

namespace coslam::saver_test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

// A disk that is full or stuck when it is told to.
class Disk {
 public:
  void write(const std::vector<Row>& rows) {
    std::unique_lock lock(mutex_);
    ++tries_;
    changed_.notify_all();
    changed_.wait(lock, [this] { return !stuck_; });
    if (full_) throw UserError("the disk is full");
    for (const Row& row : rows) keys_.push_back(row.key);
  }
  void set(bool full, bool stuck) {
    const std::lock_guard lock(mutex_);
    full_ = full;
    stuck_ = stuck;
    changed_.notify_all();
  }
  void wait_tries(int count) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return tries_ >= count; });
  }
  std::vector<std::int64_t> keys() {
    const std::lock_guard lock(mutex_);
    return keys_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  int tries_ = 0;
  bool full_ = false, stuck_ = false;
  std::vector<std::int64_t> keys_;
};

std::vector<Row> row(std::int64_t key) { return {{"point", key, "x"}}; }

class SaverTest : public testing::Test {
 protected:
  Disk disk_;
  Saver saver_{[this](const std::vector<Row>& rows) { disk_.write(rows); }, 1ms};
};

TEST_F(SaverTest, WritesInOrder) {
  for (int i = 0; i < 20; ++i) saver_.give(row(i));
  saver_.finish(10s);
  EXPECT_THAT(disk_.keys(), testing::SizeIs(20));
  EXPECT_TRUE(std::ranges::is_sorted(disk_.keys()));
  EXPECT_TRUE(saver_.idle());
  EXPECT_EQ(saver_.accept_agent_pose(), std::nullopt);
}

TEST_F(SaverTest, AStuckDiskHoldsNobodyUp) {
  disk_.set(false, true);
  saver_.give(row(1));
  disk_.wait_tries(1);
  EXPECT_FALSE(saver_.idle());
  saver_.give(row(2));
  EXPECT_THAT(test::error_of<UserError>([&] { saver_.finish(1ms); }), HasSubstr("disk is slow"));
  disk_.set(false, false);
  saver_.finish(10s);
  EXPECT_EQ(disk_.keys(), (std::vector<std::int64_t>{1, 2}));
}

TEST_F(SaverTest, AFullDiskIsSaidOnceAndLosesNothing) {
  disk_.set(true, false);
  saver_.give(row(1));
  saver_.give(row(2));
  disk_.wait_tries(5);
  EXPECT_THAT(saver_.accept_agent_pose().value_or(""), HasSubstr("the disk is full; mapping goes on"));
  EXPECT_EQ(saver_.accept_agent_pose(), std::nullopt);
  EXPECT_THAT(test::error_of<UserError>([&] { saver_.finish(1ms); }), HasSubstr("the disk is full"));
  disk_.set(false, false);
  saver_.finish(10s);
  EXPECT_EQ(disk_.keys(), (std::vector<std::int64_t>{1, 2}));
  EXPECT_THAT(saver_.accept_agent_pose().value_or(""), HasSubstr("written again"));
}

TEST(Saver, EndsThoughTheDiskStaysFull) {
  Disk disk;
  disk.set(true, false);
  Saver saver([&disk](const std::vector<Row>& rows) { disk.write(rows); }, 1ms);
  saver.give(row(1));
  disk.wait_tries(2);
}

}  // namespace
}  // namespace coslam::saver_test
