// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/flow/background_job.h"

#include <gtest/gtest.h>

#include <future>
#include <memory>

namespace coslam::background_job_test {
namespace {

TEST(BackgroundJob, IsBusyUntilItsResultIsTaken) {
  BackgroundJob<int> beside("test");
  EXPECT_FALSE(beside.busy());
  EXPECT_FALSE(beside.take(true)) << "nothing to wait for";
  std::promise<void> go;
  beside.start([&] {
    go.get_future().wait();
    return 7;
  });
  EXPECT_TRUE(beside.busy());
  EXPECT_FALSE(beside.take());
  go.set_value();
  EXPECT_EQ(beside.take(true), 7);
  EXPECT_FALSE(beside.busy());
  beside.start([] { return 8; });
  EXPECT_EQ(beside.take(true), 8);
}

TEST(BackgroundJob, EndsAfterTheJobInWork) {
  const auto kept = std::make_shared<int>(0);
  {
    BackgroundJob<int> beside("test");
    beside.start([kept] { return *kept; });
  }
  EXPECT_EQ(kept.use_count(), 1) << "neither job nor thread is left";
}

}  // namespace
}  // namespace coslam::background_job_test
