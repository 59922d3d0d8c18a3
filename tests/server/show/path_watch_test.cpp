// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/path_watch.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "tests/support/sim_run.h"

namespace coslam::path_watch_test {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::seconds;

CameraId cam(int i) { return CameraId(static_cast<std::uint16_t>(i)); }

class PathWatchTest : public testing::Test {
 protected:
  PathWatchTest() : run_(world_, {}, {.noise_px = 0.3}) {
    for (const auto& path : test::paths_side_by_side(2)) run_.add_agent(path);
  }
  // Looks until what was begun is found.
  std::optional<PathError> found(Clock::time_point now) {
    watch_.look(run_.server(), now);
    while (!watch_.path_error(cam(0))) {
      std::this_thread::yield();
      watch_.look(run_.server(), now);
    }
    return watch_.path_error(cam(0));
  }
  const test::SimWorld world_{{}};
  test::SimRun run_;
  PathWatch watch_;
  const Clock::time_point begin_ = Clock::time_point() + seconds(100);
};

TEST_F(PathWatchTest, AMapThatGrowsTellsHowGoodItsPathsAre) {
  run_.step(180);
  const auto path = found(begin_);
  ASSERT_TRUE(path && path->sigma);
  const test::PathError truth = run_.path_error();
  const double map_from_truth = 1 / truth.scale;
  EXPECT_NEAR(path->length / map_from_truth, run_.path_error(cam(0)).path_m, 0.2 * run_.path_error(cam(0)).path_m);
  const double expected_m = *path->sigma / map_from_truth;
  EXPECT_GT(expected_m, 0.2 * truth.ate);
  EXPECT_LT(expected_m, 5 * truth.ate);
  EXPECT_TRUE(watch_.path_error(cam(1)));
  EXPECT_FALSE(watch_.path_error(cam(7)));
}

TEST_F(PathWatchTest, NothingIsSaidOfAMapThatHasJustBegun) {
  run_.step(20);
  for (int i = 0; i < 10; ++i) watch_.look(run_.server(), begin_ + seconds(10 * i));
  EXPECT_FALSE(watch_.path_error(cam(0)));
}

TEST_F(PathWatchTest, LooksSeldom) {
  run_.step(150);
  const double length = found(begin_)->length;
  run_.step(60);
  for (int i = 0; i < 100; ++i) watch_.look(run_.server(), begin_ + seconds(1));
  EXPECT_EQ(watch_.path_error(cam(0))->length, length) << "it is not due yet";
  while (watch_.path_error(cam(0))->length == length) watch_.look(run_.server(), begin_ + seconds(1000));
  EXPECT_GT(watch_.path_error(cam(0))->length, length);
}

}  // namespace
}  // namespace coslam::path_watch_test
