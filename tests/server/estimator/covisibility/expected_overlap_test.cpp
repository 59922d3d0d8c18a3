// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/covisibility/expected_overlap.h"

#include <gmock/gmock.h>

#include "tests/support/sim_map.h"

namespace coslam::expected_overlap_test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;

CameraId cam(int i) { return CameraId(static_cast<std::uint16_t>(i)); }

// Two cameras that stand still and follow points of their own: they share none.
class ExpectedOverlapTest : public testing::Test {
 protected:
  ExpectedOverlapReport run(const Rigid3& first, const Rigid3& second, const ViewGraph& graph = {}) {
    test::SimMap sim(world_, {test::still_path(first), test::still_path(second)});
    sim.advance();
    for (int c = 0; c < 2; ++c) {
      for (const auto& [id, t] : sim.map.camera(cam(c)).tracks) {
        sim.bind(sim.create(world_.position(sim.world_point(cam(c), id))), cam(c), t);
      }
    }
    while (!sim.map.every(sim.map.config().match_period_s)) sim.advance();
    return stage_.run(sim.map, sim.set, {graph}, group_);
  }
  ViewGraph linked_by(int shared) const {
    ViewGraph graph;
    graph.edges.push_back({.first = cam(0), .second = cam(1), .shared = shared});
    return graph;
  }

  const test::SimWorld world_{{}};
  const Rigid3 left_ = test::looking({-0.1, 0, 0}), right_ = test::looking({0.1, 0, 0});
  const Rigid3 back_ = test::looking({0.1, 0, 0}, 1.5);
  const GroupingConfig group_;
  ExpectedOverlap stage_{ExpectedOverlap::Config()};
};

TEST_F(ExpectedOverlapTest, SideBySideWithoutSharedPointsEachShouldSeeWhatTheOtherSees) {
  EXPECT_THAT(run(left_, right_).cameras,
              ElementsAre(Pair(cam(0), ElementsAre(cam(1))), Pair(cam(1), ElementsAre(cam(0)))));
}

TEST_F(ExpectedOverlapTest, EnoughSharedPointsHoldThemTogether) {
  EXPECT_THAT(run(left_, right_, linked_by(group_.min_shared)).cameras, IsEmpty());
  EXPECT_EQ(run(left_, right_, linked_by(group_.min_shared - 1)).cameras.size(), 2U);
}

TEST_F(ExpectedOverlapTest, CamerasThatLookElsewhereAreNotExpected) {
  EXPECT_EQ(run(left_, right_).cameras.size(), 2U);
  EXPECT_THAT(run(left_, back_).cameras, IsEmpty()) << "what was found before is forgotten";
}

TEST_F(ExpectedOverlapTest, WhatWasFoundHoldsUntilTheNextLook) {
  const ExpectedOverlapReport found = run(left_, right_);
  test::SimMap sim(world_, {test::still_path(left_), test::still_path(back_)});
  sim.advance();
  while (sim.map.every(sim.map.config().match_period_s)) sim.advance();
  EXPECT_EQ(stage_.run(sim.map, sim.set, {ViewGraph()}, group_).cameras, found.cameras);
}

}  // namespace
}  // namespace coslam::expected_overlap_test
