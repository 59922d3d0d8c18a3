// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "server/estimator/adjust/apply_refine.h"
#include "server/estimator/adjust/refine.h"
#include "tests/support/sim_map.h"

namespace coslam {

inline constexpr int kSets = 66, kKeyEvery = 6, kFirstDrifted = 12;

// A map of three cameras over eleven key frames and five sets more. From set 12 on it drifts: smoothly, and for all
// cameras alike.
class RefineTest : public testing::Test {
 protected:
  // -1: never.
  struct Faults {
    int joint_set = -1;   // the second camera's pose rests on moving points
    int spoilt_set = -1;  // 20 points are seen elsewhere
  };
  RefineTest() : RefineTest(Faults()) {}
  explicit RefineTest(const Faults& faults) : sim_(world_, test::paths_side_by_side(3)) {
    for (int i = 0; i < kSets; ++i) {
      sim_.look();
      if (i == faults.spoilt_set) spoil_observations();
      sim_.take();
      sim_.place_truly();
      if (i == faults.joint_set)
        sim_.edit.set_joint_pose(sim_.map.camera(cam(1)), sim_.truth(cam(1), sim_.set.id), true);
      if (i % kKeyEvery != 0) continue;
      sim_.add_points(0.002);
      sim_.edit.add_key_frame(sim_.set.id);
    }
    for (const MapCamera& c : sim_.map.cameras()) {
      for (const FramePose& f : c.frames) sim_.edit.adjust_pose(c, f, drifted(f.cam_from_world, f.set));
    }
  }
  void spoil_observations() {
    for (const auto& [id, p] : sim_.map.points()) {
      if (p.key_observations.size() < 9 || p.bound.empty() || spoilt_.size() == 20) continue;
      const BoundTrack& b = p.bound.front();
      TrackObservation* seen = sim_.seen(b.camera, sim_.world_point(b.camera, b.track));
      if (seen == nullptr) continue;
      seen->undistorted_px += Eigen::Vector2f(25, -20);
      spoilt_[id] = {sim_.set.id, b.camera, b.track, seen->undistorted_px};
    }
  }
  static Rigid3 drifted(const Rigid3& pose, SetId at) {
    const double s = std::max(0.0, (at.value - double{kFirstDrifted}) / kSets);
    return pose * Rigid3(so3_exp({0, 0.02 * s, 0.01 * s}), {0.1 * s, 0.05 * s, -0.05 * s});
  }
  RefineJob plan(RefineExtent extent = RefineExtent::kWindow) {
    auto job = plan_refine(sim_.map, sim_.id, extent, config_);
    EXPECT_TRUE(job);
    return job ? *job : RefineJob();
  }
  RefineReport refine(RefineExtent extent = RefineExtent::kWindow) {
    const RefineJob job = plan(extent);
    return apply_refine(sim_.edit, job, solve_refine(job));
  }
  Rigid3 pose(int camera, int set) {
    return sim_.map.camera(cam(camera)).frame_at(SetId(static_cast<std::uint32_t>(set)))->cam_from_world;
  }
  Rigid3 truth(int camera, int set) { return sim_.truth(cam(camera), SetId(static_cast<std::uint32_t>(set))); }
  double worst_m(int first, int last) {
    double worst = 0;
    for (int c = 0; c < 3; ++c) {
      for (int s = first; s <= last; ++s) worst = std::max(worst, (pose(c, s).center() - truth(c, s).center()).norm());
    }
    return worst;
  }
  static CameraId cam(int i) { return CameraId(static_cast<std::uint16_t>(i)); }

  BundleAdjustmentConfig config_;
  const test::SimWorld world_{{}};
  test::SimMap sim_;
  std::map<PointId, KeyObservation> spoilt_;
};

}  // namespace coslam
