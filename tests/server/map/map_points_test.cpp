// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

#include "server/map/map.h"
#include "tests/support/matchers.h"
#include "tests/support/sim_map.h"

// What happens to points: bindings, key observations, fusion.
namespace coslam {
namespace {

constexpr CameraId kCam0(0), kCam1(1);

bool observed(const MapPoint& p, SetId set, CameraId camera, TrackId track) {
  return std::any_of(p.key_observations.begin(), p.key_observations.end(),
                     [&](const KeyObservation& o) { return o.set == set && o.camera == camera && o.track == track; });
}

bool sorted(const MapPoint& p) {
  return std::is_sorted(p.key_observations.begin(), p.key_observations.end(), [](const auto& a, const auto& b) {
    return std::tie(a.set, a.camera, a.track) < std::tie(b.set, b.camera, b.track);
  });
}

bool unique(const MapPoint& p) {
  return std::adjacent_find(p.key_observations.begin(), p.key_observations.end(), [](const auto& a, const auto& b) {
           return std::tie(a.set, a.camera, a.track) == std::tie(b.set, b.camera, b.track);
         }) == p.key_observations.end();
}

// Bindings are told twice, by the track and by the point, and what moves by the point and by the map; they must agree.
void expect_consistent(const Map& map) {
  std::vector<const MapPoint*> moving;
  for (const auto& [id, p] : map.points()) {
    if (p.state == PointState::kDynamic) moving.push_back(&p);
  }
  EXPECT_EQ(map.moving_points(), moving);
  for (const auto& [id, p] : map.points()) {
    EXPECT_EQ(id, p.id);
    EXPECT_TRUE(sorted(p) && unique(p)) << id.value;
    for (const BoundTrack& b : p.bound) {
      const auto at = map.camera(b.camera).tracks.find(b.track);
      ASSERT_NE(at, map.camera(b.camera).tracks.end());
      EXPECT_EQ(at->second.point, id);
    }
  }
  for (const MapCamera& c : map.cameras()) {
    for (const auto& [id, t] : c.tracks) {
      if (t.point == PointId()) continue;
      const MapPoint* p = map.find(t.point);
      ASSERT_NE(p, nullptr);
      EXPECT_EQ(std::count(p->bound.begin(), p->bound.end(), BoundTrack{c.id, id}), 1);
    }
  }
}

class MapPointsTest : public testing::Test {
 protected:
  MapPointsTest() : sim_(world_, test::paths_side_by_side(2)) {
    sim_.advance(3, true);
    while (!sim_.all_follow(shared_)) ++shared_;
  }
  Map& map() { return sim_.map; }
  ServerTrack& track(CameraId camera) { return *sim_.track_of(camera, shared_); }

  const test::SimWorld world_{{}};
  test::SimMap sim_;
  int shared_ = 0;  // a world point that both cameras see
};

TEST_F(MapPointsTest, BindTellsBothSidesAndTakesPatchAndKeyObservations) {
  map().add_key_frame(SetId(1));
  MapPoint& p = sim_.add_point(shared_);
  expect_consistent(map());
  EXPECT_EQ(p.bound.size(), 2U);
  EXPECT_EQ(p.key_observations.size(), 2U);
  EXPECT_TRUE(observed(p, SetId(1), kCam0, track(kCam0).id));
  ASSERT_EQ(p.patches.size(), 2U);
  EXPECT_EQ(p.patches[0].camera, kCam0);
  EXPECT_EQ(p.patches[0].set, track(kCam0).patch_set);
}

TEST_F(MapPointsTest, ATrackIsBoundOnce) {
  MapPoint& p = sim_.add_point(shared_);
  EXPECT_DEATH(map().bind(p, kCam0, track(kCam0)), "bound once");
}

TEST_F(MapPointsTest, DistrustedObservationsAreNotTaken) {
  map().add_key_frame(SetId(0));
  map().add_key_frame(SetId(2));
  track(kCam0).distrusted_before = 1;
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
  for (std::size_t i = 0; i < 4; ++i) map().set_state(*map().find(ids[i]), PointState::kDynamic);
  expect_consistent(map());
  map().set_state(*map().find(ids[0]), PointState::kStatic);
  map().remove_point(ids[1]);
  map().fuse(ids[2], ids[3]);
  expect_consistent(map());
  ASSERT_EQ(map().moving_points().size(), 1U);
  EXPECT_EQ(map().moving_points()[0]->id, ids[2]);
}

TEST_F(MapPointsTest, UnbindKeepsObservationsUnlessForgotten) {
  map().add_key_frame(SetId(1));
  MapPoint& p = sim_.add_point(shared_);
  map().unbind(kCam0, track(kCam0));
  EXPECT_EQ(track(kCam0).point, PointId());
  EXPECT_TRUE(observed(p, SetId(1), kCam0, track(kCam0).id));
  map().unbind_and_forget(kCam1, track(kCam1));
  EXPECT_FALSE(observed(p, SetId(1), kCam1, track(kCam1).id));
  EXPECT_TRUE(p.bound.empty());
  expect_consistent(map());
}

TEST_F(MapPointsTest, BindingAgainTakesNoObservationTwice) {
  map().add_key_frame(SetId(0));
  map().add_key_frame(SetId(1));
  MapPoint& p = sim_.add_point(shared_);
  const std::size_t before = p.key_observations.size();
  map().unbind(kCam0, track(kCam0));
  map().bind(p, kCam0, track(kCam0));
  EXPECT_EQ(p.key_observations.size(), before);
  expect_consistent(map());
}

TEST_F(MapPointsTest, AnEndedTrackLeavesItsPoint) {
  MapPoint& p = sim_.add_point(shared_);
  FrameSet set = sim_.set;
  set.id = SetId(3);
  std::erase_if(set.frames[0].frame.tracks, [&](const TrackObservation& o) { return o.track == track(kCam0).id; });
  map().ingest(set);
  EXPECT_EQ(p.bound, std::vector<BoundTrack>({{kCam1, track(kCam1).id}}));
  expect_consistent(map());
}

TEST_F(MapPointsTest, RemoveFreesTheTracks) {
  const PointId id = sim_.add_point(shared_).id;
  map().remove_point(id);
  map().remove_point(id);  // nothing happens
  EXPECT_EQ(map().find(id), nullptr);
  EXPECT_EQ(track(kCam0).point, PointId());
  EXPECT_EQ(track(kCam1).point, PointId());
  expect_consistent(map());
}

TEST_F(MapPointsTest, AKeyFrameTakesObservationsOfBoundTracks) {
  MapPoint& p = sim_.add_point(shared_);
  EXPECT_FALSE(map().is_key_frame(SetId(2)));
  map().add_key_frame(SetId(2));
  map().add_key_frame(SetId(1));  // an earlier one, later
  EXPECT_TRUE(map().is_key_frame(SetId(1)) && map().is_key_frame(SetId(2)));
  EXPECT_EQ(p.key_observations.size(), 4U);
  map().add_key_frame(SetId(2));  // again
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
  MapPoint& p = sim_.add_point(shared_);
  track(kCam0).gate_failures = 1;
  map().add_key_frame(SetId(2));
  EXPECT_FALSE(observed(p, SetId(2), kCam0, track(kCam0).id));
  EXPECT_TRUE(observed(p, SetId(2), kCam1, track(kCam1).id));
}

TEST_F(MapPointsTest, FuseMovesEverythingToTheOneThatStays) {
  map().add_key_frame(SetId(1));
  const Eigen::Matrix3d unit = Eigen::Matrix3d::Identity();
  MapPoint& a = map().create_point(sim_.id, world_.position(shared_), unit, SetId(1), 10);
  MapPoint& b = map().create_point(sim_.id, world_.position(shared_), unit, SetId(0), 5);
  map().bind(a, kCam0, track(kCam0));
  map().bind(b, kCam1, track(kCam1));
  const PointId gone = b.id;
  map().fuse(a.id, gone);
  EXPECT_EQ(map().find(gone), nullptr);
  EXPECT_EQ(track(kCam1).point, a.id);
  EXPECT_EQ(a.bound.size(), 2U);
  EXPECT_EQ(a.key_observations.size(), 2U);
  EXPECT_EQ(a.patches.size(), 2U);
  EXPECT_EQ(a.first_ns, 5);
  expect_consistent(map());
  map().fuse(a.id, a.id);  // nothing happens
  EXPECT_NE(map().find(a.id), nullptr);
}

TEST_F(MapPointsTest, FuseTakesNoObservationTwice) {
  map().add_key_frame(SetId(1));
  MapPoint& a = sim_.add_point(shared_);
  map().unbind(kCam0, track(kCam0));
  MapPoint& b = map().create_point(sim_.id, a.position, a.covariance, SetId(2), 0);
  map().bind(b, kCam0, track(kCam0));  // both hold the track's observation now
  map().fuse(a.id, b.id);
  EXPECT_EQ(a.key_observations.size(), 2U);
  expect_consistent(map());
}

TEST_F(MapPointsTest, BindingsStayConsistentOverARun) {
  test::TrackingConfig tracking{.ends = 0.05};
  test::SimMap sim(world_, test::paths_side_by_side(3), tracking);
  for (int i = 0; i < 60; ++i) {
    sim.advance(1, true);
    sim.add_points();
    if (i % 5 == 0) sim.map.add_key_frame(sim.set.id);
    if (i % 7 == 0) sim.map.remove_point(sim.map.points().begin()->first);
    if (i == 40) sim.map.restart_camera(kCam1, RunId(55), test::sim_camera());
  }
  EXPECT_GT(sim.map.points().size(), 200U);
  expect_consistent(sim.map);
}

}  // namespace
}  // namespace coslam
