// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/adjust/key_frames.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

#include "tests/support/sim_map.h"

namespace coslam::key_frames_test {
namespace {

class KeyFrameTest : public testing::Test {
 protected:
  explicit KeyFrameTest(const std::vector<test::CameraPath>& paths = test::paths_side_by_side(2))
      : sim_(world_, paths) {
    sim_.advance();
    sim_.add_points();
  }
  bool step() {
    sim_.advance();
    return decide();
  }
  bool decide() { return decide_key_frame(sim_.edit, sim_.set, config_); }

  const KeyFramesConfig config_;
  const test::SimWorld world_{{}};
  test::SimMap sim_;
};

TEST_F(KeyFrameTest, TheFirstWithPoints) {
  test::SimMap empty(world_, test::paths_side_by_side(1));
  empty.advance();
  EXPECT_FALSE(decide_key_frame(empty.edit, empty.set, config_));
  EXPECT_TRUE(decide());
  EXPECT_TRUE(sim_.map.is_key_frame(sim_.set.id));
}

TEST_F(KeyFrameTest, MovingCamerasGetOneNowAndThen) {
  decide();
  int last = 0, keys = 0;
  for (int i = 1; i < 150; ++i) {
    const bool key = step();
    EXPECT_EQ(key, sim_.map.is_key_frame(sim_.set.id));
    if (!key) continue;
    EXPECT_GE(i - last, kLeastFrames);
    last = i;
    ++keys;
  }
  EXPECT_GE(keys, 5);
  EXPECT_LE(keys, 40);
}

TEST_F(KeyFrameTest, WhereImagesAreSeldomEachMayBeOne) {
  test::SimMap sim(world_, {[](double t_s) { return test::looking({0.5 * t_s, 0, 0}); }});
  sim.period_ns = 1'000'000'000;
  int keys = 0;
  for (int i = 0; i < 12; ++i) {
    sim.advance();
    sim.add_points();
    keys += decide_key_frame(sim.edit, sim.set, config_);
  }
  EXPECT_GE(keys, 10) << "half a metre at 5 m";
}

TEST_F(KeyFrameTest, LosingThirtyPercentInOneCameraIsEnough) {
  decide();
  for (int i = 0; i < kLeastFrames; ++i) ASSERT_FALSE(step()) << i;
  const MapCamera& c = sim_.map.camera(CameraId(1));
  int bound = 0, freed = 0;
  for (const auto& [id, t] : c.tracks) bound += t.bound();
  const auto free = [&](double share) {
    for (const auto& [id, t] : c.tracks) {
      if (!t.bound() || freed >= share * bound) continue;
      sim_.edit.unbind(c.id, t, Why::kOutsideGate);
      ++freed;
    }
  };
  free(0.2);
  EXPECT_FALSE(step()) << "a fifth";
  free(0.4);
  EXPECT_TRUE(step()) << "two fifths";
}

// One of six turns, the others stand still.
class KeyFramesOfMany : public KeyFrameTest {
 protected:
  static constexpr int kTurning = 2;
  static std::vector<test::CameraPath> paths(int cameras) {
    std::vector<test::CameraPath> out;
    for (int i = 0; i < cameras; ++i) {
      const double turn = i == kTurning ? 0.5 : 0;
      out.emplace_back([=](double t_s) { return test::looking({0.3 * i, 0, 0}, turn * t_s); });
    }
    return out;
  }
  explicit KeyFramesOfMany(int cameras = 6) : KeyFrameTest(paths(cameras)) {}
  // Cameras that gave observations at the newest key frame.
  std::set<CameraId> took_part() const {
    const SetId key = sim_.map.key_frames().back().set;
    std::set<CameraId> out;
    for (const MapPoint* p : sim_.map.points_observed_at({key})) {
      for (const KeyObservation& o : p->key_observations) {
        if (o.set == key) out.insert(o.camera);
      }
    }
    return out;
  }
  bool next() {
    for (int i = 0; i < 60; ++i) {
      sim_.advance();
      sim_.add_points();
      if (decide()) return true;
    }
    return false;
  }
};

TEST_F(KeyFramesOfMany, OnlyThoseThatNeedOneTakePart) {
  ASSERT_TRUE(decide());
  EXPECT_EQ(took_part().size(), 6U) << "the first";
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(next());
    EXPECT_EQ(took_part(), std::set{CameraId(kTurning)});
    const SetId key = sim_.map.key_frames().back().set;
    EXPECT_TRUE(sim_.map.keeps_observations_of(key, CameraId(kTurning)));
    EXPECT_FALSE(sim_.map.keeps_observations_of(key, CameraId(0)));
  }
}

TEST_F(KeyFramesOfMany, ASparedOneComparesWithItsOwnLast) {
  ASSERT_TRUE(decide());
  ASSERT_TRUE(next());
  const MapCamera& still = sim_.map.camera(CameraId(0));
  int left = 0;
  for (const auto& [id, t] : still.tracks) {
    if (t.bound() && ++left > 10) sim_.edit.unbind(still.id, t, Why::kOutsideGate);
  }
  ASSERT_TRUE(next());
  EXPECT_TRUE(took_part().contains(still.id)) << "it lost most of what it saw at the first";
}

class KeyFramesOfAFew : public KeyFramesOfMany {
 protected:
  KeyFramesOfAFew() : KeyFramesOfMany(4) {}
};

TEST_F(KeyFramesOfAFew, AllTakePart) {
  ASSERT_TRUE(decide());
  ASSERT_TRUE(next());
  EXPECT_EQ(took_part().size(), 4U);
}

class HoveringKeyFrames : public KeyFrameTest {
 protected:
  HoveringKeyFrames() : KeyFrameTest({test::still_path(test::looking({0, 0, 0}))}) {}
};

TEST_F(HoveringKeyFrames, OneIsEnough) {
  EXPECT_TRUE(decide());
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(step());
  EXPECT_EQ(sim_.map.key_frames().size(), 1U);
}

}  // namespace
}  // namespace coslam::key_frames_test
