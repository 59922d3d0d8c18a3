// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/pose/inter_pose.h"

#include <gtest/gtest.h>

#include "tests/support/matchers.h"
#include "tests/support/sim_map.h"

namespace coslam::inter_pose_test {
namespace {

using test::PoseNear;

constexpr CameraId kPoor(2);

// Three cameras that see what stands and what moves, all mapped. In the newest set the third has no pose, and of its
// static points only three are left.
class InterPoseTest : public testing::Test {
 protected:
  InterPoseTest() : sim_(world_, test::paths_side_by_side(3), {.max_tracks = 400}) {
    sim_.advance(6, true);
    sim_.add_points(0.003);
    for (int p = 0; p < world_.size(); ++p) {
      if (world_.moves(p)) sim_.add_point(p, 0.01, Eigen::Vector3d::Zero(), PointPhase::kMoving);
    }
    sim_.ingest();
    sim_.place_truly(CameraId(0));
    sim_.place_truly(CameraId(1));
    int kept = 0;
    for (const auto& [id, t] : sim_.map.camera(kPoor).tracks) {
      const MapPoint* p = sim_.map.find(t.point);
      if (p != nullptr && p->proven() && ++kept > 3) sim_.edit.unbind(kPoor, t, Why::kOutsideGate);
    }
  }
  InterPoseReport run(const InterPoseConfig& config = {}) {
    return inter_pose(sim_.edit, sim_.set, view_graph(sim_.map, sim_.set), config, {}, &motions_);
  }
  const FramePose& frame() { return sim_.map.camera(kPoor).frames.back(); }

  const test::SimWorld world_{{.points = 300, .moving_points = 75}};
  test::SimMap sim_;
  std::map<CameraId, SteadyMotion> motions_;
};

TEST_F(InterPoseTest, FindsTheCameraThatHasNoStaticPoints) {
  ASSERT_FALSE(frame().valid());
  const InterPoseReport report = run();
  EXPECT_EQ(report.calls, 1);
  EXPECT_EQ(report.rescued, 1);
  EXPECT_EQ(report.posed, 3);
  ASSERT_TRUE(frame().valid());
  EXPECT_THAT(frame().cam_from_world, PoseNear(sim_.truth(kPoor, sim_.set.id), 0.005, 0.03));
  EXPECT_TRUE(sim_.map.camera(kPoor).corrected) << "its agent is told";
  EXPECT_TRUE(frame().joint);
  for (const CameraId rich : {CameraId(0), CameraId(1)}) {
    EXPECT_THAT(sim_.map.camera(rich).frames.back().cam_from_world,
                PoseNear(sim_.truth(rich, sim_.set.id), 0.004, 0.02));
    EXPECT_FALSE(sim_.map.camera(rich).frames.back().joint);
  }
}

TEST_F(InterPoseTest, NotWhenStaticPointsAreEnough) {
  sim_.advance(1);
  for (const MapPoint* p : sim_.map.moving_points()) sim_.edit.remove_point(*p, Why::kNoOnePlace);
  for (const auto& [id, t] : sim_.map.camera(kPoor).tracks) {
    if (!t.bound() && !world_.moves(sim_.world_point(kPoor, id))) sim_.add_point(sim_.world_point(kPoor, id));
  }
  EXPECT_EQ(run().calls, 0);
}

TEST_F(InterPoseTest, NotWithoutEnoughThatMoves) { EXPECT_EQ(run({.min_moving = 1000}).calls, 0); }

TEST_F(InterPoseTest, SwitchedOffTheCameraStaysLost) {
  EXPECT_EQ(run({.enabled = false}).calls, 0);
  EXPECT_FALSE(frame().valid());
}

}  // namespace
}  // namespace coslam::inter_pose_test
