// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/adjust/key_frame.h"

#include <gtest/gtest.h>

#include "server/associate/cull.h"
#include "tests/support/sim_map.h"

// Key frames, and what is thrown away.
namespace coslam {
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

  const KeyFrameConfig config_;
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

class HoveringKeyFrames : public KeyFrameTest {
 protected:
  HoveringKeyFrames() : KeyFrameTest({test::still_path(test::looking({0, 0, 0}))}) {}
};

TEST_F(HoveringKeyFrames, OneIsEnough) {
  EXPECT_TRUE(decide());
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(step());
  EXPECT_EQ(sim_.map.key_frames().size(), 1U);
}

TEST_F(KeyFrameTest, CullRemovesWhatFailedItsProbation) {
  const CullConfig config;
  const auto make = [&](int views) {
    const MapPoint& p = sim_.create({0, 0, 5}, 1);
    for (int i = 0; i < views; ++i) sim_.edit.see(p);
    return p.id;
  };
  const PointId poor = make(3), good = make(12);
  const PointId bound_poor = sim_.map.points().begin()->first;
  ASSERT_FALSE(sim_.map.find(bound_poor)->bound.empty());
  for (std::uint32_t i = 1; i < sim_.map.sets_in(config.probation_s); ++i) sim_.advance();
  EXPECT_EQ(cull(sim_.edit, sim_.set, config).removed, 0);
  sim_.advance();
  const int removed = cull(sim_.edit, sim_.set, config).removed;
  EXPECT_GE(removed, 1);
  EXPECT_EQ(sim_.map.find(poor), nullptr);
  EXPECT_NE(sim_.map.find(good), nullptr);
  const MapPoint* bound = sim_.map.find(bound_poor);
  EXPECT_TRUE(bound == nullptr || !bound->bound.empty());
}

TEST_F(HoveringKeyFrames, CullKeepsFewPatchesTheFirstAndTheNewest) {
  const MapPoint& p = sim_.map.points().begin()->second;
  const BoundTrack seen = p.bound.front();
  const auto first = sim_.set.id.value + 1;
  for (int i = 0; i < 50; ++i) {
    sim_.advance(1, true);
    sim_.edit.give_patch(p, seen.camera, sim_.map.track(seen));
  }
  ASSERT_EQ(p.patches.size(), 50U);
  cull(sim_.edit, sim_.set, {});
  EXPECT_LE(p.patches.size(), 8U);
  EXPECT_EQ(p.patches.front().set, SetId(first));
  EXPECT_EQ(p.patches.back().set, sim_.set.id);
}

}  // namespace
}  // namespace coslam
