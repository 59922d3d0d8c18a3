// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/adjust/final_poses.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/support/matchers.h"
#include "tests/support/sim_map.h"

namespace coslam::final_poses_test {
namespace {

using test::PoseNear;

constexpr int kSets = 40, kKeyEvery = 8;

// A map of two cameras at their true poses.
class SettleTest : public testing::Test {
 protected:
  SettleTest() : sim_(world_, test::paths_side_by_side(2)) {
    for (int i = 0; i < kSets; ++i) {
      sim_.advance();
      if (i % kKeyEvery != 0) continue;
      sim_.add_points(0.002);
      sim_.edit.add_key_frame(sim_.set.id);
    }
    for (std::size_t c = 0; c < 2; ++c) {
      for (const FramePose& f : camera(c).frames) before_[c].push_back(f.cam_from_world);
    }
  }
  const MapCamera& camera(std::size_t i) const { return sim_.map.cameras()[i]; }
  const FramePose& frame(std::size_t i, int set) const { return camera(i).frames[static_cast<std::size_t>(set)]; }
  Rigid3 truth(std::size_t i, int set) { return sim_.truth(camera(i).id, frame(i, set).set); }
  void spoil(std::size_t i, int set, const Rigid3& by) {
    sim_.edit.adjust_pose(camera(i), frame(i, set), by * frame(i, set).cam_from_world);
  }
  void lose(std::size_t i, int set) { sim_.edit.place_past(camera(i), frame(i, set), MapId(), Rigid3()); }
  // All frames but these are as they were, to the bit.
  void expect_others_stay(std::size_t i, const std::vector<int>& but) {
    for (std::size_t c = 0; c < 2; ++c) {
      for (int set = 0; set < kSets; ++set) {
        if (c == i && std::ranges::find(but, set) != but.end()) continue;
        const Rigid3 &now = frame(c, set).cam_from_world, &then = before_[c][static_cast<std::size_t>(set)];
        ASSERT_EQ(now.translation, then.translation) << c << ' ' << set;
        ASSERT_EQ(now.rotation.coeffs(), then.rotation.coeffs()) << c << ' ' << set;
      }
    }
  }

  const test::SimWorld world_{{}};
  test::SimMap sim_;
  std::vector<Rigid3> before_[2];
};

TEST_F(SettleTest, HoldsTracksAllOverTheImage) {
  for (const FramePose& f : camera(0).frames) {
    ASSERT_GE(f.held.size(), 24U);
    ASSERT_LE(f.held.size(), 48U);
    double left = 1e9, right = -1e9;
    for (const HeldTrack& t : f.held) {
      left = std::min<double>(left, t.undistorted_px.x());
      right = std::max<double>(right, t.undistorted_px.x());
    }
    EXPECT_GT(right - left, 0.6 * camera(0).model.width_px);
  }
}

TEST_F(SettleTest, LeavesGoodPosesAlone) {
  const FinalPosesReport report = refine_final_poses(sim_.edit, sim_.id);
  EXPECT_EQ(report.solved, 2 * kSets);
  EXPECT_EQ(report.changed, 0);
  EXPECT_EQ(report.placed, 0);
  expect_others_stay(0, {});
}

TEST_F(SettleTest, BringsAFrameThatIsFarOffBack) {
  spoil(1, 13, Rigid3(so3_exp({0, 0.01, 0}), {0.15, 0, -0.05}));
  EXPECT_EQ(refine_final_poses(sim_.edit, sim_.id).changed, 1);
  EXPECT_THAT(frame(1, 13).cam_from_world, PoseNear(truth(1, 13), 0.004, 0.03));
  expect_others_stay(1, {13});
}

// The tracks of the first frames got their points at the key frames that came later.
TEST_F(SettleTest, PlacesFramesWithoutAPoseFromEitherSide) {
  const std::vector<int> lost{0, 1, 2, 20, 21, 22, 39};
  for (const int set : lost) lose(0, set);
  EXPECT_EQ(refine_final_poses(sim_.edit, sim_.id).placed, 7);
  for (const int set : lost) {
    EXPECT_EQ(frame(0, set).map, sim_.id);
    EXPECT_THAT(frame(0, set).cam_from_world, PoseNear(truth(0, set), 0.004, 0.03)) << set;
  }
  expect_others_stay(0, lost);
}

// What the adjustment found of a lens that is not as calibrated holds for every frame.
TEST_F(SettleTest, LooksThroughTheLensThatTheAdjustmentFound) {
  CameraModel calibrated = camera(0).model;
  calibrated.fx /= 1.03;
  calibrated.fy /= 1.03;
  LensCorrection lens, other_way;
  lens.values[0] = std::log(1.03);
  other_way.values[0] = -std::log(1.03);
  // Of the same places in the raw image: another calibration alone leaves what was seen in its direction.
  sim_.edit.correct_lens(camera(0), other_way, LensCorrection::Values::Zero());
  sim_.edit.restart_camera(camera(0).id, camera(0).run, calibrated);
  sim_.edit.correct_lens(camera(0), lens, LensCorrection::Values::Zero());
  EXPECT_EQ(refine_final_poses(sim_.edit, sim_.id).changed, 0);
  expect_others_stay(0, {});
  spoil(0, 13, Rigid3(so3_exp({0, 0.01, 0}), {0.15, 0, -0.05}));
  EXPECT_EQ(refine_final_poses(sim_.edit, sim_.id).changed, 1);
  EXPECT_THAT(frame(0, 13).cam_from_world, PoseNear(truth(0, 13), 0.004, 0.03));
  sim_.edit.correct_lens(camera(0), {}, LensCorrection::Values::Zero());
  EXPECT_GT(refine_final_poses(sim_.edit, sim_.id).changed, kSets / 2) << "with the calibration they are elsewhere";
}

TEST_F(SettleTest, LeavesOtherMapsAlone) {
  const MapId other = sim_.edit.new_map(Why::kStartedAlone, 0);
  sim_.edit.place_past(camera(0), frame(0, 5), other, Rigid3());
  EXPECT_EQ(refine_final_poses(sim_.edit, sim_.id).placed, 0);
  EXPECT_EQ(frame(0, 5).map, other);
}

}  // namespace
}  // namespace coslam::final_poses_test
