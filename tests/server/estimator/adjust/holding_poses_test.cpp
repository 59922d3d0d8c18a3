// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/adjust/holding_poses.h"

#include <gtest/gtest.h>

#include <map>

#include "server/estimator/adjust/refine.h"
#include "tests/support/sim_map.h"

namespace coslam::holding_poses_test {
namespace {

// One camera has many points, the other few of its own.
TEST(HoldingPoses, EachCameraIsHeldByPosesThatSeeWhatItSees) {
  constexpr int kFew = 30;
  const test::SimWorld world{{}};
  test::SimMap sim(world, test::paths_side_by_side(2));
  sim.advance(1);
  for (const CameraId c : {CameraId(0), CameraId(1)}) {
    int points = 0;
    for (int p = 0; p < world.size(); ++p) {
      const ServerTrack* t = sim.track_of(c, p);
      if (t == nullptr || (c == CameraId(1) && ++points > kFew)) continue;
      sim.bind(sim.create(world.position(p)), c, *t);
    }
  }
  for (int key = 0; key < 8; ++key) {
    sim.edit.add_key_frame(sim.set.id);
    sim.advance(3);
  }
  BundleAdjustmentConfig config;
  config.window = 2;
  const auto job = plan_refine(sim.map, sim.id, RefineExtent::kWindow, config);
  ASSERT_TRUE(job);
  std::map<CameraId, int> holding;
  for (std::size_t i = 0; i < job->poses.size(); ++i) holding[job->poses[i].camera] += job->problem.poses[i].fixed;
  EXPECT_GE(holding[CameraId(0)], 3 * config.window) << "those that hold most";
  EXPECT_EQ(holding[CameraId(1)], 3);
}

}  // namespace
}  // namespace coslam::holding_poses_test
