// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/associate/fuse.h"

#include <gtest/gtest.h>

#include <vector>

#include "common/geometry/triangulation.h"
#include "tests/support/sim_map.h"

namespace coslam::fuse_test {
namespace {

constexpr CameraId kCam0(0), kCam1(1);

// Two cameras with true poses, and for every static world point that both follow, two map points: one from each.
class FuseTest : public testing::Test {
 protected:
  FuseTest() : sim_(world_, test::paths_side_by_side(2)) {
    sim_.advance(10, true);
    for (int p = 0; p < world_.size(); ++p) {
      if (world_.moves(p) || !sim_.all_follow(p)) continue;
      map_alone(p, kCam0, {0.004, 0, 0.01});
      map_alone(p, kCam1, {-0.004, 0, -0.01});
      twice_.push_back(p);
    }
  }
  void map_alone(int world_point, CameraId camera, const Eigen::Vector3d& off_m) {
    sim_.bind(sim_.create(world_.position(world_point) + off_m), camera, *sim_.track_of(camera, world_point));
  }
  FuseReport fuse() { return fuse_points(sim_.edit, sim_.set); }
  PointId point_of(CameraId camera, int world_point) { return sim_.track_of(camera, world_point)->point; }

  const test::SimWorld world_{{}};
  test::SimMap sim_;
  std::vector<int> twice_;
};

TEST_F(FuseTest, MakesOneOfTwoAndNothingElse) {
  ASSERT_GT(twice_.size(), 50U);
  const FuseReport report = fuse();
  EXPECT_GE(report.fused, 0.9 * static_cast<double>(twice_.size()));
  EXPECT_EQ(sim_.map.points().size(), 2 * twice_.size() - static_cast<std::size_t>(report.fused));
  std::vector<double> errors, values;
  for (const auto& [id, p] : sim_.map.points()) {
    if (p.bound.size() < 2) continue;
    ASSERT_EQ(p.bound.size(), 2U);
    const int truth = sim_.world_point(p.bound[0].camera, p.bound[0].track);
    EXPECT_EQ(sim_.world_point(p.bound[1].camera, p.bound[1].track), truth);
    const Eigen::Vector3d error = p.position - world_.position(truth);
    errors.push_back(error.norm());
    values.push_back(test::nees(error, p.covariance));
  }
  EXPECT_LT(test::median(errors), 0.02);
  EXPECT_LT(test::median(values), 6);
  EXPECT_EQ(fuse().fused, 0) << "done is done";
}

TEST(FuseOfThreeTest, WhatBecameOneIsJudgedAnewWithTheThird) {
  const test::SimWorld world{{}};
  test::SimMap sim(world, test::paths_side_by_side(3));
  sim.advance(10, true);
  int thrice = 0;
  for (int p = 0; p < world.size(); ++p) {
    if (world.moves(p) || !sim.all_follow(p)) continue;
    ++thrice;
    for (std::uint16_t c = 0; c < 3; ++c) {
      const Eigen::Vector3d off_m(0.004 * (c - 1), 0, 0.01 * (c - 1));
      sim.bind(sim.create(world.position(p) + off_m), CameraId(c), *sim.track_of(CameraId(c), p));
    }
  }
  ASSERT_GT(thrice, 40);
  fuse_points(sim.edit, sim.set);
  int ones = 0;
  for (const auto& [id, p] : sim.map.points()) {
    if (p.bound.size() < 3) continue;
    ++ones;
    std::vector<View> views;
    for (const BoundTrack& b : p.bound) {
      const MapCamera& c = sim.map.camera(b.camera);
      const auto frames = static_cast<std::size_t>(c.frames_in(sim.map.config().check_back_s, 2));
      const std::vector<View> of_track = sim.map.views_of(c, sim.map.track(b), frames);
      views.insert(views.end(), of_track.begin(), of_track.end());
    }
    EXPECT_LT((p.position - triangulate(views, 1.0, 0.0).position).norm(), 1e-9) << "by the views of all three";
  }
  EXPECT_GE(ones, 0.8 * thrice);
}

TEST_F(FuseTest, WhatACameraSawAtOnceStaysTwo) {
  const int p = twice_.front();
  // A second track of the first camera on the second's point: it sees both.
  const MapPoint& other = *sim_.map.find(point_of(kCam1, p));
  const ServerTrack& neighbour = *sim_.track_of(kCam0, twice_[1]);
  sim_.edit.unbind(kCam0, neighbour, Why::kOutsideGate);
  sim_.bind(other, kCam0, neighbour);
  fuse();
  EXPECT_NE(point_of(kCam0, p), point_of(kCam1, p));
}

TEST_F(FuseTest, SeenApartAtAnEarlierKeyFrameCountsToo) {
  const int p = twice_.front();
  constexpr TrackId kSecond(9999);  // of the first camera, at the same place
  sim_.look(true);
  sim_.set.frames[0].frame.tracks.push_back({kSecond, sim_.seen(kCam0, p)->undistorted_px});
  sim_.take();
  sim_.place_truly();
  sim_.bind(*sim_.map.find(point_of(kCam1, p)), kCam0, sim_.map.camera(kCam0).tracks.at(kSecond));
  sim_.edit.add_key_frame(sim_.set.id);
  sim_.advance(1, true);
  ASSERT_FALSE(sim_.map.camera(kCam0).tracks.contains(kSecond)) << "it has ended";
  fuse();
  EXPECT_NE(point_of(kCam0, p), point_of(kCam1, p));
}

TEST_F(FuseTest, AnotherLookIsRefused) {
  const int p = twice_.front();
  sim_.edit.remove_point(*sim_.map.find(point_of(kCam0, p)), Why::kTooFewViews);
  sim_.look(true);
  sim_.patch_of(kCam0, p)->grey = world_.patch(twice_[1]);
  sim_.take();
  sim_.place_truly();
  map_alone(p, kCam0, {0.004, 0, 0.01});
  fuse();
  EXPECT_NE(point_of(kCam0, p), point_of(kCam1, p));
}

TEST_F(FuseTest, OnePositionMustExplainThePastOfBoth) {
  const int p = twice_.front();
  sim_.look(true);
  sim_.seen(kCam1, p)->undistorted_px += Eigen::Vector2f(0, 15);
  sim_.take();
  sim_.place_truly();
  sim_.advance(1, true);
  fuse();
  EXPECT_NE(point_of(kCam0, p), point_of(kCam1, p));
}

TEST_F(FuseTest, OnlyStaticPointsOfTheSameMap) {
  for (const auto& [id, p] : sim_.map.points()) {
    if (p.bound.front().camera == kCam1) sim_.set_moving(p);
  }
  EXPECT_EQ(fuse().candidates, 0);
}

}  // namespace
}  // namespace coslam::fuse_test
