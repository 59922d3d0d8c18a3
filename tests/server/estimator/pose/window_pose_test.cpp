// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/pose/window_pose.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/estimator/pose/localise.h"
#include "tests/support/sim_map.h"

namespace coslam::window_pose_test {
namespace {

constexpr CameraId kCam(0);
constexpr double kDegree = std::numbers::pi / 180;

// Stands for a second, turns on the spot for three by 60 degrees in each, and stands again. Points are there where it
// looks at first; of the rest of the world it follows corners that nobody knows.
Rigid3 turning(double t_s) {
  const double turned_s = std::clamp(t_s - 1.0, 0.0, 3.0);
  return test::looking(
      {0, 0, 0},
      60 * kDegree * (turned_s - std::sin(2 * std::numbers::pi * turned_s / 3) * 3 / (2 * std::numbers::pi)));
}

class WindowPoseTest : public testing::Test {
 protected:
  static constexpr double kDepth_m = 5;
  WindowPoseTest() : sim_(world_, {turning}, {.ends = 0.03}) {
    sim_.advance(2);
    sim_.add_points(0.01);
  }
  void follow(int sets) {
    for (int i = 0; i < sets; ++i) {
      sim_.ingest();
      localise(sim_.edit, sim_.set, {});
      solved_ += static_cast<int>(window_.run(sim_.edit, sim_.set).solved.size());
    }
  }
  const MapCamera& camera() { return sim_.map.camera(kCam); }
  double turn_off_rad() {
    return camera().frames.back().cam_from_world.rotation.angularDistance(sim_.truth(kCam, sim_.set.id).rotation);
  }
  double place_off_m() { return camera().frames.back().cam_from_world.center().norm(); }

  const test::SimWorld world_{{.layout = test::Layout::kAround, .points = 1500}};
  test::SimMap sim_;
  WindowPose window_{WindowPoseConfig{}};
  int solved_ = 0;
};

TEST_F(WindowPoseTest, ACameraThatTurnsAwayFromAllPointsStaysWhereItIs) {
  double most_off_m = 0, most_off_rad = 0;
  for (int i = 0; i < 135; ++i) {
    follow(1);
    ASSERT_TRUE(camera().frames.back().valid()) << i;
    most_off_m = std::max(most_off_m, place_off_m());
    most_off_rad = std::max(most_off_rad, turn_off_rad());
  }
  EXPECT_GT(solved_, 60);
  EXPECT_LT(most_off_rad, 1.0 * kDegree);
  EXPECT_LT(most_off_m, 0.01 * kDepth_m);
  EXPECT_EQ(camera().map, sim_.id);
}

TEST_F(WindowPoseTest, WithPointsEnoughItDoesNothing) {
  follow(25);
  EXPECT_EQ(solved_, 0);
}

TEST_F(WindowPoseTest, ItGoesOnUntilPointsAreManyAgain) {
  follow(25);
  const auto unbind_all_but = [&](int left) {
    for (const auto& [id, t] : camera().tracks) {
      if (t.bound() && --left < 0) sim_.edit.unbind(kCam, t, Why::kOutsideGate);
    }
  };
  const auto bind = [&](int more) {
    for (const auto& [id, t] : camera().tracks) {
      if (t.bound() || more-- <= 0) continue;
      sim_.bind(sim_.create(world_.position(sim_.world_point(kCam, id))), kCam, t);
    }
  };
  unbind_all_but(25);
  follow(1);
  EXPECT_EQ(solved_, 1);
  bind(20);
  follow(1);
  EXPECT_EQ(solved_, 2) << "it does not hang on the number from set to set";
  bind(40);
  follow(1);
  EXPECT_EQ(solved_, 2);
  unbind_all_but(45);
  follow(1);
  EXPECT_EQ(solved_, 2);
}

TEST_F(WindowPoseTest, PosesThatRestOnWhatMovesStay) {
  follow(60);
  ASSERT_GT(solved_, 0);
  const Rigid3 beside = retract(sim_.truth(kCam, sim_.set.id), (Vector6d() << 0.01, 0, 0, 0, 0, 0).finished());
  sim_.ingest();
  sim_.place_truly();
  sim_.edit.set_joint_pose(camera(), beside, true);
  window_.run(sim_.edit, sim_.set);
  EXPECT_EQ(camera().frames.back().cam_from_world.translation, beside.translation);
  EXPECT_EQ(camera().frames.back().cam_from_world.rotation.coeffs(), beside.rotation.coeffs());
}

TEST_F(WindowPoseTest, WithoutAMapItDoesNothing) {
  follow(60);
  sim_.edit.leave_map(camera());
  const int before = solved_;
  follow(2);
  EXPECT_EQ(solved_, before);
}

TEST_F(WindowPoseTest, SwitchedOffItDoesNothing) {
  window_.config.enabled = false;
  follow(60);
  EXPECT_EQ(solved_, 0);
}

}  // namespace
}  // namespace coslam::window_pose_test
