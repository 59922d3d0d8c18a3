// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/motion/classify.h"

#include <gtest/gtest.h>

#include "tests/support/sim_map.h"

namespace coslam {
namespace {

constexpr CameraId kCam0(0);

// A moving point that one camera alone still sees, at a depth that it has no longer: its track slid onto the wall.
TEST(Classify, OneCameraGivesBackWhatStandsStill) {
  const test::SimWorld world({});
  test::SimMap sim(world, test::paths_side_by_side(2));
  sim.advance(10, true);
  sim.add_points();
  const MapPoint* on_wall = nullptr;
  for (const auto& [id, p] : sim.map.points()) {
    if (p.bound.size() == 2 && (on_wall == nullptr || p.position.z() > on_wall->position.z())) on_wall = &p;
  }
  ASSERT_NE(on_wall, nullptr);
  const Eigen::Vector3d place = on_wall->position, eye = sim.truth(kCam0, sim.set.id).center();
  const int world_point = sim.world_point(*on_wall);
  sim.edit.remove_point(*on_wall, Why::kNoOnePlace);
  const MapPoint& p = sim.create(eye + 0.6 * (place - eye), 0.03, PointPhase::kMoving);
  const PointId id = p.id;
  const ServerTrack* track = sim.track_of(kCam0, world_point);
  sim.edit.bind_moving(p, kCam0, *track, Eigen::Vector2f::Zero(), Why::kLooksLikeIt);
  const ClassifyConfig config;
  for (int i = 0; i < 2 * config.still_frames + 2; ++i) {
    sim.advance(1, true);
    track = sim.track_of(kCam0, world_point);
    ASSERT_NE(track, nullptr);
    classify(sim.edit, sim.set, config);
  }
  EXPECT_NE(track->point, id);
  EXPECT_FALSE(track->moves());
}

}  // namespace
}  // namespace coslam
