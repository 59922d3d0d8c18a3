// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/places/unite.h"

#include <gtest/gtest.h>

#include <tuple>
#include <vector>

#include "tests/support/map_checks.h"
#include "tests/support/map_fit.h"
#include "tests/support/matchers.h"

namespace coslam::unite_test {
namespace {

using test::cam;
using test::PoseNear;
using test::VectorNear;

class UniteTest : public testing::Test {
 protected:
  void TearDown() override { test::expect_consistent(sim_.map); }
  const MapCamera& camera(int i) const { return sim_.map.camera(cam(i)); }
  const ServerTrack& track(int c, int world_point) const { return *sim_.track_of(cam(c), world_point); }
  std::vector<int> common() const {
    std::vector<int> points;
    for (int p = 0; p < world_.size(); ++p) {
      if (sim_.all_follow(p)) points.push_back(p);
    }
    return points;
  }
  // A point in a map, bound to the track of one camera.
  PointId mapped(int c, int world_point, MapId in, const Eigen::Vector3d& at) {
    const MapPoint& p = sim_.create(in, at);
    sim_.bind(p, cam(c), track(c, world_point));
    return p.id;
  }
  PointId mapped(int c, int world_point) { return mapped(c, world_point, sim_.id, world_.position(world_point)); }

  const test::SimWorld world_{{}};
  test::SimMap sim_{world_, test::paths_side_by_side(2), {.noise_px = 0}};
};

TEST_F(UniteTest, AFreeTrackIsBoundAndThePointTriangulatedAnew) {
  sim_.advance(3);
  const std::vector<int> points = common();
  const int p = points.at(0);
  const PointId id = mapped(0, p, sim_.id, world_.position(p) + Eigen::Vector3d(0.2, 0.2, 0));
  sim_.advance(1);
  bind_matches(sim_.edit, newest_image(camera(1)), {{track(1, p).id, id}, {track(1, points.at(1)).id, PointId(999)}});
  EXPECT_EQ(track(1, p).point, id);
  EXPECT_FALSE(track(1, points.at(1)).bound()) << "its point is gone";
  EXPECT_THAT(sim_.map.find(id)->position, VectorNear(world_.position(p), 0.1));
  EXPECT_EQ(sim_.map.find(id)->last_seen, sim_.map.now());
  const Event& e = sim_.edit.journal().events().back();
  EXPECT_EQ(std::tuple(e.kind, e.why, e.figures[0]), std::tuple(EventKind::kTrackBound, Why::kPlaceRecognised, 2));
}

TEST_F(UniteTest, WhatIsSeenApartOrMovesStaysApart) {
  sim_.advance(3);
  const std::vector<int> points = common();
  const PointId first = mapped(0, points.at(0)), second = mapped(0, points.at(1));
  const PointId beside = mapped(1, points.at(0)), mover = mapped(1, points.at(1)), own = mapped(1, points.at(3));
  sim_.bind(*sim_.map.find(beside), cam(0), track(0, points.at(2)));
  sim_.set_moving(*sim_.map.find(mover));
  bind_matches(
      sim_.edit, newest_image(camera(1)),
      {{track(1, points.at(0)).id, first}, {track(1, points.at(1)).id, second}, {track(1, points.at(4)).id, own}});
  EXPECT_EQ(track(1, points.at(0)).point, beside) << "camera 0 sees both";
  EXPECT_EQ(track(1, points.at(1)).point, mover);
  EXPECT_FALSE(track(1, points.at(4)).bound()) << "another track of the camera shows it";
}

// Camera 0 has a map; camera 1 was in another one at the first set and then in none.
TEST_F(UniteTest, ACameraIsPlacedBackToItsLastPose) {
  const MapId other = sim_.edit.new_map(Why::kStartedAlone, 1);
  for (int i = 0; i < 8; ++i) {
    sim_.ingest();
    sim_.place_truly(cam(0));
    if (i > 0) continue;
    sim_.place(cam(1), other, Rigid3());
    sim_.edit.leave_map(camera(1));
  }
  PlaceMatch seen{.map = sim_.id, .cam_from_world = sim_.truth(cam(1), sim_.set.id)};
  for (const int p : common()) seen.matches.emplace_back(track(1, p).id, mapped(0, p));
  const MapEpoch before = sim_.map.epoch();
  place(sim_.edit, newest_image(camera(1)), seen, {});
  EXPECT_GT(sim_.map.epoch(), before);
  EXPECT_EQ(camera(1).map, sim_.id);
  EXPECT_EQ(camera(1).frames.front().map, other);
  for (std::size_t i = 1; i < 8; ++i) {
    const FramePose& f = camera(1).frames[i];
    EXPECT_EQ(f.map, sim_.id);
    EXPECT_THAT(f.cam_from_world, PoseNear(sim_.truth(cam(1), f.set), 0.005, 0.03));
  }
  for (const auto& [t, p] : seen.matches) EXPECT_EQ(camera(1).tracks.at(t).point, p);
}

// Camera 0 is in the older map, which is the world; camera 1 in one of its own.
class JoinTest : public UniteTest {
 protected:
  // Camera 1 saw the other one's map, after so many frames of each.
  void join_after(int frames, int own_frames, bool own_is_metric = false) {
    for (int i = 0; i < 4; ++i) {
      sim_.ingest();
      if (i < frames) sim_.place_truly(cam(0));
      if (i < own_frames) sim_.place(cam(1), own_, transform_world(sim_.truth(cam(1), sim_.set.id), own_from_world_));
    }
    if (own_is_metric) sim_.edit.set_metric(own_);
    const int p = point_ = common().at(0);
    const PointId kept = mapped(0, p);
    mapped(1, p, own_, own_from_world_ * world_.position(p));
    const PlaceMatch seen{.map = sim_.id, .matches = {{track(1, p).id, kept}}};
    join(sim_.edit, newest_image(camera(1)), seen, own_from_world_.inverse());
    EXPECT_NE(sim_.map.find(kept), nullptr);
  }
  void expect_all_in(MapId map, const Similarity3& map_from_world) {
    for (int c = 0; c < 2; ++c) {
      EXPECT_EQ(camera(c).map, map);
      const FramePose& f = camera(c).frames.front();
      EXPECT_EQ(f.map, map);
      EXPECT_THAT(f.cam_from_world, PoseNear(transform_world(sim_.truth(cam(c), f.set), map_from_world), 1e-9, 1e-9));
    }
    // The points are one, in the right place.
    ASSERT_EQ(sim_.map.points().size(), 1U);
    const MapPoint& p = sim_.map.points().begin()->second;
    EXPECT_EQ(p.bound.size(), 2U);
    EXPECT_THAT(p.position, VectorNear(map_from_world * world_.position(point_), 0.1));
  }
  const MapId own_ = sim_.edit.new_map(Why::kStartedAlone, 1);
  const Similarity3 own_from_world_{2, so3_exp({0.1, 0.8, -0.2}), {5, -2, 1}};
  int point_ = 0;
};

TEST_F(JoinTest, TheSmallerThatWasSeenComesIntoTheLarger) {
  join_after(3, 4);
  expect_all_in(own_, own_from_world_);
}

TEST_F(JoinTest, OfTwoEqualOnesTheOlderStays) {
  join_after(4, 4);
  expect_all_in(sim_.id, {});
}

TEST_F(JoinTest, MetresStayMetres) {
  join_after(4, 3, true);
  expect_all_in(own_, own_from_world_);
}

// Camera 0 sees at the last set, where it is a little beside, what it saw at the first.
TEST_F(UniteTest, AClosedLoopHoldsFromThenOn) {
  const Similarity3 off{1.02, so3_exp({0, 0.01, 0}), {0.1, 0, 0}};
  for (int i = 0; i < 10; ++i) {
    sim_.ingest();
    sim_.place_truly(cam(1));
    sim_.place(cam(0), transform_world(sim_.truth(cam(0), sim_.set.id), i < 9 ? Similarity3() : off));
  }
  const int p = common().at(0);
  const PlaceMatch seen{.map = sim_.id,
                        .cam_from_world = sim_.truth(cam(0), sim_.set.id),
                        .matches = {{track(0, p).id, mapped(1, p)}},
                        .key_camera = cam(1),
                        .key_set = SetId(2)};
  std::vector<LoopConstraint> loops;
  ASSERT_TRUE(close(sim_.edit, newest_image(camera(0)), seen, off.inverse(), {}, &loops));
  ASSERT_EQ(loops.size(), 1U);
  const LoopConstraint& l = loops[0];
  EXPECT_EQ(std::tuple(l.camera, l.set, l.to_camera, l.to_set), std::tuple(cam(0), SetId(9), cam(1), SetId(2)));
  EXPECT_EQ(l.scale, off.inverse().scale);
  const Rigid3& there = camera(1).frames[2].cam_from_world;
  EXPECT_THAT(camera(0).frames.back().cam_from_world * there.inverse(), PoseNear(l.camera_from_to, 1e-9, 0.01));
  EXPECT_TRUE(track(0, p).bound());
}

TEST_F(UniteTest, ALoopThatCannotBeClosedChangesNothing) {
  sim_.advance(1);
  const int p = common().at(0);
  const PlaceMatch seen{.map = sim_.id, .matches = {{track(0, p).id, mapped(1, p)}}, .key_camera = cam(1)};
  std::vector<LoopConstraint> loops;
  EXPECT_FALSE(close(sim_.edit, newest_image(camera(0)), seen, {}, {}, &loops)) << "the first frame does not move";
  EXPECT_TRUE(loops.empty());
  EXPECT_FALSE(track(0, p).bound());
}

}  // namespace
}  // namespace coslam::unite_test
