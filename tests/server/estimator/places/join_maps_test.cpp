// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/places/join_maps.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/support/map_checks.h"
#include "tests/support/map_fit.h"
#include "tests/support/sim_map.h"

// Maps that are joined by their remembered images, without any camera running.
namespace coslam::join_maps_test {
namespace {

using test::cam;
using test::Fit;
using test::fit_of;
using testing::IsEmpty;

// Two cameras side by side, each with a map of its own. That of the second is turned, and 2.5 times as large.
class JoinMapsTest : public testing::Test {
 protected:
  explicit JoinMapsTest(const test::WorldConfig& world = {.points = 250}, double second_yaw_rad = 0)
      : world_(world),
        sim_(world_, {test::wave_path({.center_m = {-0.3, 0, 0}}),
                      test::wave_path({.center_m = {0.3, 0, 0}, .yaw_rad = second_yaw_rad})}) {}

  // So many images are remembered of each camera, a third of a second apart.
  void remember(int of_first, int of_second) {
    for (int i = 0; i < std::max(of_first, of_second); ++i) {
      for (int k = 0; k < 10; ++k) step(k == 9);
      add_points();
      if (i < of_first) remember(cam(0));
      if (i < of_second) remember(cam(1));
    }
  }
  void step(bool descriptors) {
    sim_.ingest(false, descriptors);
    sim_.place_truly(cam(0));
    sim_.place(cam(1), own_, transform_world(sim_.truth(cam(1), sim_.set.id), own_from_world_));
  }
  void add_points() {
    sim_.add_points();
    for (int p = 0; p < world_.size(); ++p) {
      const ServerTrack* t = sim_.track_of(cam(1), p);
      if (t == nullptr || t->bound()) continue;
      sim_.bind(sim_.create(own_, own_from_world_ * world_.position(p)), cam(1), *t);
    }
  }
  void remember(CameraId id) {
    places_.add(sim_.edit, newest_image(sim_.map.camera(id)), *sim_.set.frames[id.value].descriptors);
  }
  std::vector<JoinedMaps> join() { return join_all_maps(sim_.edit, places_); }

  const test::SimWorld world_;
  test::SimMap sim_;
  const MapId own_ = sim_.edit.new_map(Why::kStartedAlone, 1);
  const Similarity3 own_from_world_{2.5, so3_exp({0.1, 0.8, -0.2}), {5, -2, 1}};
  KeyImageDatabase places_{RecogniseConfig{}};
};

TEST_F(JoinMapsTest, MapsThatShowOnePlaceBecomeOneWithOneScale) {
  remember(3, 3);
  const std::vector<JoinedMaps> joined = join();
  ASSERT_EQ(joined.size(), 1U);
  EXPECT_EQ(joined[0].removed, own_);
  EXPECT_EQ(joined[0].remaining, sim_.id) << "the older one";
  EXPECT_GE(joined[0].images, 2);
  EXPECT_GE(joined[0].points, 20);
  EXPECT_NEAR(joined[0].scale, 1 / 2.5, 0.01);
  EXPECT_EQ(sim_.map.camera(cam(1)).map, sim_.id);
  const Fit fit = fit_of(sim_, sim_.id);
  EXPECT_EQ(fit.poses, 60);
  EXPECT_NEAR(fit.map_from_world.scale, 1, 0.02);
  EXPECT_LT(fit.worst_pose_m, 0.08);
  EXPECT_LT(fit.worst_pose_rad, 0.01);
  test::expect_consistent(sim_.map);
  EXPECT_THAT(join(), IsEmpty()) << "there is one map now";
}

TEST_F(JoinMapsTest, PointsThatTheImagesSayAreOneAreFused) {
  remember(3, 3);
  const std::size_t before = sim_.map.points().size();
  const std::vector<JoinedMaps> joined = join();
  ASSERT_EQ(joined.size(), 1U);
  EXPECT_EQ(sim_.map.points().size(), before - static_cast<std::size_t>(joined[0].points));
  for (const auto& [id, p] : sim_.map.points()) {
    EXPECT_EQ(p.map, sim_.id);
    for (const BoundTrack& b : p.bound) EXPECT_EQ(sim_.world_point(b.camera, b.track), sim_.world_point(p));
  }
}

TEST_F(JoinMapsTest, TheMapInMetresKeepsItsFrame) {
  remember(3, 3);
  sim_.edit.set_metric(own_);
  const Rigid3 pose = sim_.map.camera(cam(1)).frames.back().cam_from_world;
  const std::vector<JoinedMaps> joined = join();
  ASSERT_EQ(joined.size(), 1U);
  EXPECT_EQ(joined[0].remaining, own_);
  EXPECT_NEAR(joined[0].scale, 2.5, 0.06);
  EXPECT_EQ(sim_.map.camera(cam(0)).map, own_);
  EXPECT_EQ(sim_.map.camera(cam(1)).frames.back().cam_from_world.translation, pose.translation);
}

TEST_F(JoinMapsTest, TwoImagesThatRecogniseEachOtherAreNotEnough) {
  remember(1, 1);
  EXPECT_THAT(join(), IsEmpty());
}

TEST_F(JoinMapsTest, WithoutImagesOfTheOtherMapNothingIsJoined) {
  remember(3, 0);
  EXPECT_THAT(join(), IsEmpty());
  EXPECT_THAT(join_all_maps(sim_.edit, KeyImageDatabase(RecogniseConfig())), IsEmpty());
}

TEST_F(JoinMapsTest, OnlyMapsFromTheFirstOnBecomePartOfOlderOnes) {
  remember(3, 3);
  EXPECT_THAT(join_maps(sim_.edit, places_, MapId(3)), IsEmpty());
  const std::vector<JoinedMaps> joined = join_maps(sim_.edit, places_, MapId(2));
  ASSERT_EQ(joined.size(), 1U);
  EXPECT_EQ(joined[0].remaining, sim_.id);
}

TEST_F(JoinMapsTest, AMapWhosePointsLieElsewhereThanTheyWereSeenIsNotJoined) {
  remember(1, 1);
  for (const MapPoint* p : test::scan(sim_.map, [&](const MapPoint& q) { return q.map == own_; })) {
    sim_.shift(*p, 6 * Eigen::Vector3d(0, 0, std::sin(1.7 * p->id.value)));
  }
  const MapEpoch before = sim_.map.epoch();
  EXPECT_THAT(join(), IsEmpty());
  EXPECT_EQ(sim_.map.epoch(), before) << "nothing moved";
}

class JoinMapsAtAWall : public JoinMapsTest {
 protected:
  JoinMapsAtAWall() : JoinMapsTest({.layout = test::Layout::kPlane, .points = 250}) {}
};

TEST_F(JoinMapsAtAWall, WhatIsFlatMayHangInTwoPlaces) {
  remember(3, 3);
  EXPECT_THAT(join(), IsEmpty());
}

class JoinMapsApart : public JoinMapsTest {
 protected:
  JoinMapsApart() : JoinMapsTest({.layout = test::Layout::kAround, .points = 500}, 3.1) {}
};

TEST_F(JoinMapsApart, WhatLooksElsewhereStaysAMapOfItsOwn) {
  remember(3, 3);
  EXPECT_THAT(join(), IsEmpty());
  EXPECT_EQ(sim_.map.camera(cam(1)).map, own_);
}

}  // namespace
}  // namespace coslam::join_maps_test
