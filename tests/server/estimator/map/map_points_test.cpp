// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "server/estimator/map/edit.h"
#include "tests/support/map_checks.h"
#include "tests/support/sim_map.h"

// What happens to points: bindings, key observations, fusion.
namespace coslam::map_points_test {
namespace {

using test::expect_consistent;
using test::observed;

constexpr CameraId kCam0(0), kCam1(1);

class MapPointsTest : public testing::Test {
 protected:
  MapPointsTest() : sim_(world_, test::paths_side_by_side(2)) {
    sim_.advance(3, true);
    while (!sim_.all_follow(shared_)) ++shared_;
  }
  const Map& map() { return sim_.map; }
  MapEdit& edit() { return sim_.edit; }
  const ServerTrack& track(CameraId camera) { return *sim_.track_of(camera, shared_); }

  const test::SimWorld world_{{}};
  test::SimMap sim_;
  int shared_ = 0;  // a world point that both cameras see
};

TEST_F(MapPointsTest, BindTellsBothSidesAndTakesPatchAndKeyObservations) {
  edit().add_key_frame(SetId(1));
  const MapPoint& p = sim_.add_point(shared_);
  expect_consistent(map());
  EXPECT_EQ(p.bound.size(), 2U);
  EXPECT_EQ(p.key_observations.size(), 2U);
  EXPECT_TRUE(observed(p, SetId(1), kCam0, track(kCam0).id));
  ASSERT_EQ(p.patches.size(), 2U);
  EXPECT_EQ(p.patches[0].camera, kCam0);
  EXPECT_EQ(p.patches[0].set, track(kCam0).patch_set);
}

TEST_F(MapPointsTest, ATrackIsBoundOnce) {
  const MapPoint& p = sim_.add_point(shared_);
  EXPECT_DEATH(sim_.bind(p, kCam0, track(kCam0)), "bound once");
}

TEST_F(MapPointsTest, DistrustedObservationsAreNotTaken) {
  edit().add_key_frame(SetId(0));
  edit().add_key_frame(SetId(2));
  edit().distrust_before(track(kCam0), SetId(1));
  const MapPoint& p = sim_.add_point(shared_);
  EXPECT_FALSE(observed(p, SetId(0), kCam0, track(kCam0).id));
  EXPECT_TRUE(observed(p, SetId(2), kCam0, track(kCam0).id));
  EXPECT_TRUE(observed(p, SetId(0), kCam1, track(kCam1).id));
}

TEST_F(MapPointsTest, TheMapKnowsWhatMoves) {
  sim_.add_points();
  std::vector<PointId> ids;
  for (const auto& [id, p] : map().points()) ids.push_back(id);
  ASSERT_GT(ids.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) sim_.set_moving(*map().find(ids[i]));
  expect_consistent(map());
  edit().stop_moving(*map().find(ids[0]), 2);
  edit().remove_point(*map().find(ids[1]), Why::kNoOnePlace);
  edit().fuse(ids[2], ids[3], Why::kOneMover);
  expect_consistent(map());
  ASSERT_EQ(map().moving_points().size(), 1U);
  EXPECT_EQ(map().moving_points()[0]->id, ids[2]);
}

TEST_F(MapPointsTest, UnbindKeepsObservationsUnlessForgotten) {
  edit().add_key_frame(SetId(1));
  const MapPoint& p = sim_.add_point(shared_);
  edit().unbind(kCam0, track(kCam0), Why::kOutsideGate);
  EXPECT_EQ(track(kCam0).point, PointId());
  EXPECT_TRUE(observed(p, SetId(1), kCam0, track(kCam0).id));
  edit().unbind(kCam1, track(kCam1), Why::kOutsideGate);
  edit().drop_observation(p, SetId(1), kCam1, track(kCam1).id);
  EXPECT_FALSE(observed(p, SetId(1), kCam1, track(kCam1).id));
  EXPECT_TRUE(p.bound.empty());
  expect_consistent(map());
}

TEST_F(MapPointsTest, BindingAgainTakesNoObservationTwice) {
  edit().add_key_frame(SetId(0));
  edit().add_key_frame(SetId(1));
  const MapPoint& p = sim_.add_point(shared_);
  const std::size_t before = p.key_observations.size();
  edit().unbind(kCam0, track(kCam0), Why::kOutsideGate);
  sim_.bind(p, kCam0, track(kCam0));
  EXPECT_EQ(p.key_observations.size(), before);
  expect_consistent(map());
}

TEST_F(MapPointsTest, AnEndedTrackLeavesItsPoint) {
  const MapPoint& p = sim_.add_point(shared_);
  FrameSet set = sim_.set;
  set.id = SetId(3);
  std::erase_if(set.frames[0].frame.tracks, [&](const TrackObservation& o) { return o.track == track(kCam0).id; });
  edit().ingest(set);
  EXPECT_EQ(p.bound, std::vector<BoundTrack>({{kCam1, track(kCam1).id}}));
  expect_consistent(map());
}

TEST_F(MapPointsTest, RemoveFreesTheTracks) {
  const MapPoint& p = sim_.add_point(shared_);
  const PointId id = p.id;
  edit().remove_point(p, Why::kTooFewViews);
  EXPECT_EQ(map().find(id), nullptr);
  EXPECT_EQ(track(kCam0).point, PointId());
  EXPECT_EQ(track(kCam1).point, PointId());
  expect_consistent(map());
}

TEST_F(MapPointsTest, AKeyFrameTakesObservationsOfBoundTracks) {
  const MapPoint& p = sim_.add_point(shared_);
  EXPECT_FALSE(map().is_key_frame(SetId(2)));
  edit().add_key_frame(SetId(2));
  edit().add_key_frame(SetId(1));  // an earlier one, later
  EXPECT_TRUE(map().is_key_frame(SetId(1)) && map().is_key_frame(SetId(2)));
  EXPECT_EQ(p.key_observations.size(), 4U);
  edit().add_key_frame(SetId(2));  // again
  EXPECT_EQ(p.key_observations.size(), 4U);
  EXPECT_EQ(map().key_frames().size(), 2U);
  expect_consistent(map());
  const std::vector<View> views = map().key_views_of(p);
  EXPECT_EQ(views.size(), 4U);
  for (const View& v : views) {
    EXPECT_LT((v.camera->project(v.cam_from_world * world_.position(shared_)) - v.undistorted_px).norm(), 2.5);
  }
}

TEST_F(MapPointsTest, AKeyFrameSkipsTracksThatFailTheGate) {
  const MapPoint& p = sim_.add_point(shared_);
  edit().miss_gate(kCam0, track(kCam0), 3);
  edit().add_key_frame(SetId(2));
  EXPECT_FALSE(observed(p, SetId(2), kCam0, track(kCam0).id));
  EXPECT_TRUE(observed(p, SetId(2), kCam1, track(kCam1).id));
}

TEST_F(MapPointsTest, FuseMovesEverythingToTheOneThatStays) {
  edit().add_key_frame(SetId(1));
  const MapPoint& b = sim_.create(world_.position(shared_));
  sim_.bind(b, kCam1, track(kCam1));
  const TimeNs first_ns = sim_.set.t_ns;
  sim_.advance();
  const MapPoint& a = sim_.create(world_.position(shared_));
  sim_.bind(a, kCam0, track(kCam0));
  const PointId gone = b.id;
  edit().fuse(a.id, gone, Why::kOneCorner);
  EXPECT_EQ(map().find(gone), nullptr);
  EXPECT_EQ(track(kCam1).point, a.id);
  EXPECT_EQ(a.bound.size(), 2U);
  EXPECT_EQ(a.key_observations.size(), 2U);
  EXPECT_EQ(a.patches.size(), 2U);
  EXPECT_EQ(a.first_ns, first_ns);
  EXPECT_EQ(a.last_ns, sim_.set.t_ns);
  expect_consistent(map());
  edit().fuse(a.id, a.id, Why::kOneCorner);  // nothing happens
  EXPECT_NE(map().find(a.id), nullptr);
}

TEST_F(MapPointsTest, FuseTakesNoObservationTwice) {
  edit().add_key_frame(SetId(1));
  const MapPoint& a = sim_.add_point(shared_);
  edit().unbind(kCam0, track(kCam0), Why::kOutsideGate);
  const MapPoint& b = sim_.create(a.position);
  sim_.bind(b, kCam0, track(kCam0));  // both hold the track's observation now
  edit().fuse(a.id, b.id, Why::kOneCorner);
  EXPECT_EQ(a.key_observations.size(), 2U);
  expect_consistent(map());
}

TEST_F(MapPointsTest, BindingsStayConsistentOverARun) {
  test::TrackingConfig tracking{.ends = 0.05};
  test::SimMap sim(world_, test::paths_side_by_side(3), tracking);
  for (int i = 0; i < 60; ++i) {
    sim.advance(1, true);
    sim.add_points();
    if (i % 5 == 0) sim.edit.add_key_frame(sim.set.id);
    if (i % 7 == 0) sim.edit.remove_point(sim.map.points().begin()->second, Why::kUndetermined);
    if (i == 40) sim.edit.restart_camera(kCam1, RunId(55), test::sim_camera());
  }
  EXPECT_GT(sim.map.points().size(), 200U);
  expect_consistent(sim.map);
}

}  // namespace
}  // namespace coslam::map_points_test
