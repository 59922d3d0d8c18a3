// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/adjust/zoom.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/server/estimator/adjust/drifted_map.h"

namespace coslam::zoom_test {
namespace {

class ZoomTest : public RefineTest {
 protected:
  ZoomTest() : job_(plan(RefineExtent::kWhole)) { job_.zooms = true; }
  static double zoom(SetId set) { return 0.02 * std::sin(0.2 * set.value); }
  // As if the second camera kept focusing.
  void breathe() {
    const CameraModel& camera = job_.problem.cameras[1];
    for (auto& o : job_.problem.observations) {
      const auto& pose = job_.poses[static_cast<std::size_t>(o.pose)];
      if (pose.camera != cam(1)) continue;
      const Eigen::Vector2d centre(camera.cx, camera.cy);
      o.undistorted_px = centre + std::exp(zoom(pose.set)) * (o.undistorted_px - centre);
    }
  }

  RefineJob job_;
};

TEST_F(ZoomTest, CamerasThatDoNotBreatheAreSolvedForAsBeforeToTheBit) {
  const BundleResult with = solve_refine(job_);
  job_.zooms = false;
  const BundleResult without = solve_refine(job_);
  EXPECT_TRUE(with.zooms.empty());
  for (std::size_t i = 0; i < job_.poses.size(); ++i) {
    EXPECT_EQ(with.poses[i].translation, without.poses[i].translation);
  }
  EXPECT_EQ(with.points, without.points);
}

TEST_F(ZoomTest, ACameraThatBreathesIsFoundAndMadeUpFor) {
  breathe();
  const BundleResult result = solve_refine(job_);
  ASSERT_EQ(result.zooms.size(), job_.poses.size());
  for (std::size_t i = 0; i < job_.poses.size(); ++i) {
    const double truth = job_.poses[i].camera == cam(1) ? zoom(job_.poses[i].set) : 0;
    EXPECT_NEAR(result.zooms[i], truth, 0.006) << i;
  }
  ASSERT_TRUE(apply_refine(sim_.edit, job_, result).applied);
  EXPECT_NEAR(sim_.map.camera(cam(1)).breathing, 0.02, 0.004);
  EXPECT_LT(sim_.map.camera(cam(0)).breathing, 0.006);
}

TEST_F(ZoomTest, WhatWasTakenOutIsRemembered) {
  sim_.edit.leave_zoom_out(sim_.map.camera(cam(1)), std::vector<FrameZoom>{{SetId(0), 0.01}});
  sim_.edit.leave_zoom_out(sim_.map.camera(cam(1)), std::vector<FrameZoom>{{SetId(0), 0.005}});
  for (const auto& pose : plan(RefineExtent::kWhole).poses)
    EXPECT_NEAR(pose.zoom_taken_out, pose.camera == cam(1) ? 0.015 : 0, 1e-6);
}

// Poses that only hold a job come after those that it moves, and are older.
TEST_F(ZoomTest, TheOrderOfPosesIsThatOfTime) {
  breathe();
  const BundleResult expected = solve_refine(job_);
  const auto turn = [](int pose, std::size_t n) { return static_cast<int>(n) - 1 - pose; };
  const std::size_t n = job_.poses.size();
  std::ranges::reverse(job_.poses);
  std::ranges::reverse(job_.problem.poses);
  for (auto& o : job_.problem.observations) o.pose = turn(o.pose, n);
  const BundleResult turned = solve_refine(job_);
  ASSERT_EQ(turned.zooms.size(), n);
  for (std::size_t i = 0; i < n; ++i) EXPECT_NEAR(turned.zooms[n - 1 - i], expected.zooms[i], 2e-4) << i;
}

TEST_F(ZoomTest, LensesThatAreGivenDoNotBreathe) {
  breathe();
  job_.problem.lenses.clear();
  EXPECT_TRUE(solve_refine(job_).zooms.empty());
}

}  // namespace
}  // namespace coslam::zoom_test
