// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/create/moving.h"

#include <gtest/gtest.h>

#include "tests/support/sim_map.h"

namespace coslam {
namespace {

constexpr CameraId kCam0(0);

// Two cameras 1.2 m apart with true poses, whose view things cross; the first few static points that both see are
// mapped, so that they share an edge.
class MapMovingTest : public testing::Test {
 protected:
  MapMovingTest() : sim_(world_, test::paths_side_by_side(2)) {
    sim_.advance(10, true);
    for (int p = 0; p < world_.size() && sim_.map.points().size() < kSeeds; ++p) {
      if (!world_.moves(p) && sim_.all_follow(p)) sim_.add_point(p);
    }
  }
  MapMovingReport step() { return map_moving(sim_.edit, sim_.set, view_graph(sim_.map, sim_.set), {}, {}); }
  // What the first camera believes of its free tracks; the number of them that stand still.
  int believe(bool moving) {
    int still = 0;
    for (const auto& [id, t] : sim_.map.camera(kCam0).tracks) {
      if (t.bound()) continue;
      sim_.edit.set_motion(kCam0, t, moving ? TrackMotion::kMoving : TrackMotion::kResting);
      still += !world_.moves(sim_.world_point(kCam0, id));
    }
    return still;
  }

  static constexpr std::size_t kSeeds = 12;
  const test::SimWorld world_{{.points = 300, .moving_points = 80}};
  test::SimMap sim_;
};

TEST_F(MapMovingTest, NothingThatNobodySeesMove) {
  believe(false);
  EXPECT_EQ(step().joined, 0);
}

// One camera knows that they move, to the other they look like things at rest farther or nearer.
TEST_F(MapMovingTest, WhatOneCameraSeesMoveIsJoinedIfItMoves) {
  ASSERT_GT(believe(true), 20);
  EXPECT_GE(step().joined, 10);
  EXPECT_GE(sim_.map.moving_points().size(), 10U);
  for (const MapPoint* p : sim_.map.moving_points()) EXPECT_TRUE(world_.moves(sim_.world_point(*p)));
  EXPECT_EQ(sim_.map.points().size(), kSeeds + sim_.map.moving_points().size()) << "nothing else is made";
}

}  // namespace
}  // namespace coslam
