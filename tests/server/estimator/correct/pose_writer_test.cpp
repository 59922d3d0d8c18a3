// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/correct/pose_writer.h"

#include <gtest/gtest.h>

#include "tests/support/sim_map.h"

namespace coslam::pose_writer_test {
namespace {

class PoseWriterTest : public testing::Test {
 protected:
  PoseWriterTest() : sim_(world_, test::paths_side_by_side(2)) { sim_.advance(); }
  std::vector<AgentPose> poses() {
    return agent_poses(sim_.map, sim_.set, RunId(7), [&](MapId map) { return map == sim_.id; });
  }

  const test::SimWorld world_{{}};
  test::SimMap sim_;
};

TEST_F(PoseWriterTest, SaysWhereEachCameraIs) {
  const auto all = poses();
  ASSERT_EQ(all.size(), 2U);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const MapCamera& camera = sim_.map.camera(sim_.set.frames[i].camera);
    EXPECT_EQ(all[i].agent, camera.name);
    EXPECT_EQ(all[i].agent_run, camera.run);
    EXPECT_EQ(all[i].server_run, RunId(7));
    EXPECT_EQ(all[i].map, sim_.id);
    EXPECT_EQ(all[i].epoch, sim_.map.epoch());
    EXPECT_EQ(all[i].t_ns, sim_.set.frames[i].frame.capture_ns);
    EXPECT_EQ(all[i].state, PoseState::kTracked);
    EXPECT_TRUE(all[i].scale_known);
    EXPECT_EQ(all[i].map_from_cam.translation, camera.frames.back().cam_from_world.center());
    EXPECT_TRUE(all[i].covariance.isZero()) << "the agent did not say";
  }
}

TEST_F(PoseWriterTest, ACovarianceIsThatOfTheAgentInTheMap) {
  TrackFrame& frame = sim_.set.frames[0].frame;
  frame.pose_state = PoseState::kTracked;
  frame.server_run = RunId(7);
  frame.pose_covariance.diagonal() << 1, 1, 1, 4, 4, 4;  // the same along all axes
  const AgentPose pose = poses()[0];
  Eigen::Matrix<float, 6, 1> expected;
  expected << 4, 4, 4, 1, 1, 1;
  EXPECT_TRUE(pose.covariance.isApprox(Eigen::Matrix<float, 6, 6>(expected.asDiagonal()), 1e-5F));
  frame.server_run = RunId(8);
  EXPECT_TRUE(poses()[0].covariance.isZero()) << "a pose in the map of another server";
}

}  // namespace
}  // namespace coslam::pose_writer_test
