// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "common/flow/worker_pool.h"
#include "server/map_server.h"
#include "tests/support/sim_run.h"

namespace coslam {
namespace {

void expect_same(const Map& a, const Map& b) {
  ASSERT_EQ(a.points().size(), b.points().size());
  for (auto p = a.points().begin(), q = b.points().begin(); p != a.points().end(); ++p, ++q) {
    ASSERT_EQ(p->first, q->first);
    ASSERT_EQ(p->second.position, q->second.position);
    ASSERT_EQ(p->second.covariance, q->second.covariance);
    ASSERT_EQ(p->second.phase, q->second.phase);
    ASSERT_EQ(p->second.bound.size(), q->second.bound.size());
  }
  ASSERT_EQ(a.cameras().size(), b.cameras().size());
  for (std::size_t c = 0; c < a.cameras().size(); ++c) {
    const FramePose &f = a.cameras()[c].frames.back(), &g = b.cameras()[c].frames.back();
    ASSERT_EQ(f.map, g.map);
    ASSERT_EQ(f.cam_from_world.translation, g.cam_from_world.translation);
    ASSERT_EQ(f.cam_from_world.rotation.coeffs(), g.cam_from_world.rotation.coeffs());
  }
}

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
    expect_same(alone.map(), shared.map());
    if (HasFatalFailure()) break;
  }
  EXPECT_GT(alone.map().points().size(), 100U);
}

}  // namespace
}  // namespace coslam
