// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "server/estimator/motion/follow.h"
#include "tests/support/sim_map.h"

namespace coslam {

// One body of 25 points that goes in a circle before cameras that move too. Its points are followed by tracks with
// noise.
class FollowBody : public testing::Test {
 protected:
  explicit FollowBody(int cameras = 2) : sim_(world_, test::paths_side_by_side(cameras), {.max_tracks = 400}) {
    sim_.advance(10, true);
    for (int i = kStatic; i < world_.size(); ++i) {
      if (sim_.all_follow(i)) body_.push_back(i);
    }
  }
  void SetUp() override { ASSERT_EQ(body_.size(), 25U); }
  const MapPoint& follow(int world_point) {
    return sim_.add_point(world_point, 0.02, Eigen::Vector3d::Zero(), PointPhase::kMoving);
  }
  // Follows all points of the body; returns the first.
  const MapPoint& follow_all() {
    for (std::size_t i = 1; i < body_.size(); ++i) follow(body_[i]);
    return follow(body_[0]);
  }
  const ServerTrack& track(CameraId camera, int world_point) { return *sim_.track_of(camera, world_point); }
  void unbind(CameraId camera, int world_point) {
    sim_.edit.unbind(camera, track(camera, world_point), Why::kOutsideGate);
  }
  FollowReport step(bool patches = false) {
    sim_.advance(1, patches);
    return follow_moving(sim_.edit, sim_.set, config_);
  }
  double error_m(const MapPoint& p) const { return (p.position - world_.position(body_[0], sim_.set.t_ns)).norm(); }
  // Way of the first point's truth since that time.
  double travelled_m(TimeNs since_ns) const {
    return (world_.position(body_[0], sim_.set.t_ns) - world_.position(body_[0], since_ns)).norm();
  }
  // Events so far that have that reason.
  std::vector<Event> events(Why why) const {
    std::vector<Event> out = sim_.edit.journal().events();
    std::erase_if(out, [&](const Event& e) { return e.why != why; });
    return out;
  }

  static constexpr int kStatic = 300;
  static constexpr CameraId kCam0{0}, kCam1{1}, kCam2{2};
  const FollowConfig config_;
  const test::SimWorld world_{{.seed = 24, .points = kStatic, .moving_points = 25}};  // all cameras see it all along
  test::SimMap sim_;
  std::vector<int> body_;  // world points that all cameras follow
};

}  // namespace coslam
