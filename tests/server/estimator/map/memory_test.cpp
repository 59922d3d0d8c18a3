// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/map/memory.h"

#include <gtest/gtest.h>

#include "tests/support/sim_map.h"

namespace coslam::memory_test {
namespace {

TEST(Memory, AnEmptyMapHoldsNothing) {
  for (const auto& [what, bytes] : memory_of(Map(MapConfig()))) EXPECT_EQ(bytes, 0U) << what;
}

TEST(Memory, GrowsWithWhatIsKept) {
  const test::SimWorld world({});
  test::SimMap sim(world, test::paths_side_by_side(2));
  sim.advance(1, true);
  const MemoryUse before = memory_of(sim.map);
  EXPECT_GE(before.at("poses"), 2 * sizeof(FramePose));
  EXPECT_EQ(before.at("points"), 0U);
  sim.add_points();
  sim.edit.add_key_frame(sim.set.id);
  const MemoryUse after = memory_of(sim.map);
  EXPECT_GE(after.at("points"), sim.map.points().size() * sizeof(MapPoint));
  EXPECT_GE(after.at("key_observations"), sim.map.points().size() * sizeof(KeyObservation));
  EXPECT_EQ(after.at("paths"), 0U);
  const MapPoint& p = *sim.map.recent_points().front();
  sim.set_moving(p);
  sim.record_now(p);
  EXPECT_GE(memory_of(sim.map).at("paths"), sizeof(MotionSample) + 2 * sizeof(Sighting));
}

TEST(Memory, PosesGrowByTheirOwnSizeAndTracksDoNotGrowWithoutEnd) {
  const test::SimWorld world({});
  test::SimMap sim(world, test::paths_side_by_side(1));
  sim.advance(300);
  const MemoryUse once = memory_of(sim.map);
  sim.advance(300);
  const MemoryUse twice = memory_of(sim.map);
  EXPECT_GE(twice.at("poses"), 600 * sizeof(FramePose));
  EXPECT_LE(twice.at("poses"), 2 * 600 * sizeof(FramePose));
  EXPECT_LT(twice.at("tracks"), 1.5 * static_cast<double>(once.at("tracks"))) << "old observations are thinned";
}

}  // namespace
}  // namespace coslam::memory_test
