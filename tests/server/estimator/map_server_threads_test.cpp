// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "common/flow/worker_pool.h"
#include "server/estimator/map_server.h"
#include "tests/support/map_checks.h"
#include "tests/support/sim_run.h"

namespace coslam::map_server_threads_test {
namespace {

// Agents' poses and tracks follow from the patches that they get, so these are the same as well.
TEST(MapServerThreads, OneOrSeveralMakeTheSameMapToTheBit) {
  const test::SimWorld world({.moving_points = 20});
  const test::TrackingConfig tracking{.outliers = 0.02, .ends = 0.01};
  test::SimRun alone(world, {}, tracking), shared(world, {}, tracking);
  WorkerPool pool("test", 3);
  shared.server().work_with(pool);
  for (test::SimRun* run : {&alone, &shared}) {
    for (const auto& path : test::paths_side_by_side(4)) run->add_agent(path);
  }
  for (int i = 0; i < 40; ++i) {
    alone.step(2);
    shared.step(2);
    test::expect_same(alone.map(), shared.map());
    if (HasFatalFailure()) break;
  }
  EXPECT_GT(alone.map().points().size(), 100U);
}

}  // namespace
}  // namespace coslam::map_server_threads_test
