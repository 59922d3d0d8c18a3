// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/motion/clock_offsets.h"

#include <gtest/gtest.h>

#include "server/estimator/motion/follow.h"
#include "tests/support/sim_map.h"

namespace coslam::clock_offsets_test {
namespace {

constexpr CameraId kFirst(0), kSecond(1), kThird(2);

// Three cameras at true poses; their tracks of moving points are bound as truth has it.
class ClockTest : public testing::Test {
 protected:
  ClockTest() : sim_(world_, test::paths_side_by_side(3), {.noise_px = 0.15, .ends = 0.01, .max_tracks = 400}) {}

  void run(int sets, const ClockOffsetsConfig& config = {}) {
    clocks_.emplace(config);
    go_on(sets);
  }
  void go_on(int sets) {
    for (int i = 0; i < sets; ++i) {
      sim_.advance();
      for (int p = 0; p < world_.size(); ++p) {
        if (world_.moves(p)) bind(p);
      }
      clocks_->run(sim_.edit);
    }
  }
  double offset_s(CameraId camera) const { return clocks_->offset(camera).offset_s; }

  test::SimMap& sim() { return sim_; }
  ClockOffsets& clocks() { return *clocks_; }

 private:
  void bind(int world_point) {
    const auto at = points_.find(world_point);
    const MapPoint* p = at == points_.end() ? nullptr : sim_.map.find(at->second);
    if (p == nullptr) {
      const MapPoint& made = sim_.add_point(world_point, 0.01, Eigen::Vector3d::Zero(), PointPhase::kMoving);
      points_[world_point] = made.id;
      return;
    }
    for (const CameraId c : {kFirst, kSecond, kThird}) {
      const ServerTrack* t = sim_.track_of(c, world_point);
      if (t != nullptr && !t->bound()) sim_.edit.bind_moving(*p, c, *t, Eigen::Vector2f::Zero(), Why::kLooksLikeIt);
    }
  }

  const test::SimWorld world_{{.points = 50, .moving_points = 100}};
  test::SimMap sim_;
  std::map<int, PointId> points_;
  std::optional<ClockOffsets> clocks_;
};

TEST_F(ClockTest, HalfAFrameIsFoundAndUsed) {
  sim().trackers[1].set_clock_behind(test::kPeriodNs / 2);
  sim().trackers[2].set_clock_behind(-test::kPeriodNs * 2 / 5);
  run(300);
  EXPECT_EQ(offset_s(kFirst), 0);
  EXPECT_NEAR(offset_s(kSecond), 1 / 60.0, 0.002);
  EXPECT_NEAR(offset_s(kThird), -2 / 150.0, 0.002);
  EXPECT_EQ(sim().map.camera(kFirst).clock_offset_ns, 0);
  EXPECT_EQ(sim().map.camera(kSecond).clock_offset_ns, to_ns(offset_s(kSecond)));
  EXPECT_EQ(sim().map.camera(kThird).clock_offset_ns, to_ns(offset_s(kThird)));
}

TEST_F(ClockTest, ClocksThatAgreeAreLeftAlone) {
  run(300);
  for (const CameraId c : {kFirst, kSecond, kThird}) {
    EXPECT_NEAR(offset_s(c), 0, 0.002);
    EXPECT_EQ(sim().map.camera(c).clock_offset_ns, 0);
  }
}

TEST_F(ClockTest, WhatIsTooUncertainIsNotUsed) {
  sim().trackers[1].set_clock_behind(test::kPeriodNs / 2);
  run(91, {.significance = 1e4});
  EXPECT_GT(offset_s(kSecond), 0.01);
  EXPECT_EQ(sim().map.camera(kSecond).clock_offset_ns, 0);
}

TEST_F(ClockTest, AnAgentThatBeginsAnewHasAnotherClock) {
  sim().trackers[1].set_clock_behind(test::kPeriodNs / 2);
  run(91);
  ASSERT_GT(offset_s(kSecond), 0.01);
  clocks().forget(kSecond);
  EXPECT_EQ(offset_s(kSecond), 0);
  sim().trackers[1].set_clock_behind(0);
  go_on(2);
  EXPECT_EQ(offset_s(kSecond), 0);
}

TEST_F(ClockTest, SwitchedOffNothingIsEstimated) {
  sim().trackers[1].set_clock_behind(test::kPeriodNs / 2);
  run(60, {.enabled = false});
  EXPECT_EQ(offset_s(kSecond), 0);
}

}  // namespace
}  // namespace coslam::clock_offsets_test
