// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/covisibility/census.h"

#include <gtest/gtest.h>

#include "tests/support/sim_map.h"

namespace coslam {
namespace {

TEST(Census, CountsWhatWasSeenLately) {
  const test::SimWorld world({});
  test::SimMap sim(world, test::paths_side_by_side(2));
  sim.advance(2);
  EXPECT_EQ(Census{}.run(sim.map).recent_points, 0);
  sim.add_points();
  EXPECT_EQ(Census{}.run(sim.map).recent_points, static_cast<int>(sim.map.points().size()));
}

}  // namespace
}  // namespace coslam
