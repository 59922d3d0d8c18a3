// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/places/close_loop.h"

#include <gtest/gtest.h>

#include <cmath>
#include <tuple>
#include <vector>

#include "tests/support/map_checks.h"
#include "tests/support/map_fit.h"
#include "tests/support/matchers.h"

namespace coslam::close_loop_test {
namespace {

using test::cam;
using test::PoseNear;
using test::VectorNear;

constexpr int kLast = 20, kMiddle = 10;
SetId at_set(int i) { return SetId(static_cast<std::uint32_t>(i)); }

// Two cameras side by side whose map drifts evenly, until the first one sees again where it began.
class CloseLoopTest : public testing::Test {
 protected:
  CloseLoopTest() {
    for (int i = 0; i <= kLast; ++i) {
      sim_.ingest();
      for (int c = 0; c < 2; ++c) sim_.place(cam(c), transform_world(truth(c, i), drift(i)));
      if (i == kMiddle) sim_.edit.add_key_frame(sim_.set.id);
    }
    for (int p = 0; p < world_.size(); ++p) {
      if (sim_.all_follow(p)) common_.push_back(p);
    }
    test::forget(sim_.edit.journal());
  }
  static Similarity3 drift(int set) {
    const double s = static_cast<double>(set) / kLast;
    return {std::exp(0.1 * s), so3_exp({0, 0.05 * s, 0}), {0.2 * s, 0, -0.1 * s}};
  }
  Rigid3 truth(int camera, int set) const { return sim_.truth(cam(camera), at_set(set)); }
  static Rigid3 pose(const MapEdit& edit, int camera, int set) {
    return edit.map().camera(cam(camera)).frame_at(at_set(set))->cam_from_world;
  }
  double off_m(const MapEdit& edit, int camera, int set) const {
    return (pose(edit, camera, set).center() - pose(sim_.edit, camera, set).center()).norm();
  }
  LoopConstraint loop(int set, int to_set) const {
    const double shrinks = drift(to_set).scale / drift(set).scale;
    return {cam(0), cam(0), at_set(set), at_set(to_set), truth(0, set) * truth(0, to_set).inverse(), shrinks};
  }
  MapEdit closed(const std::vector<LoopConstraint>& earlier = {}, const std::vector<CameraId>& together = {}) const {
    MapEdit edit = sim_.edit;
    EXPECT_TRUE(close_loop(edit, sim_.id, loop(kLast, 0), earlier, together));
    return edit;
  }
  // A point that the first cameras see at the key frame in the middle alone.
  PointId seen_in_the_middle(int world_point, int cameras) {
    const MapPoint& p = sim_.create(drift(kMiddle) * world_.position(world_point));
    for (int c = 0; c < cameras; ++c) {
      const ServerTrack& t = *sim_.track_of(cam(c), world_point);
      sim_.bind(p, cam(c), t);
      sim_.edit.unbind(cam(c), t, Why::kOddOneOut);
    }
    return p.id;
  }
  const test::SimWorld world_{{}};
  test::SimMap sim_{world_, test::paths_side_by_side(2)};
  std::vector<int> common_;  // points that both cameras follow
};

// The second camera comes to its middle by itself, and at the end finds the points of there again: it goes along with
// its middle then, and not with the first one's end.
TEST_F(CloseLoopTest, WhoIsBackAtAPlaceStaysWithIt) {
  MapConfig config;
  config.recent_s = 0.1;
  test::SimMap sim(world_, test::paths_side_by_side(2), {}, config);
  std::vector<PointId> visited;
  const auto see_all = [&] {
    for (const PointId id : visited) {
      const MapPoint& p = *sim.map.find(id);
      const ServerTrack* t = sim.track_of(cam(1), sim.world_point(p));
      if (t == nullptr) continue;
      if (!t->bound()) sim.bind(p, cam(1), *t);
    }
    sim.edit.add_key_frame(sim.set.id);
    for (const PointId id : visited) {
      const MapPoint& p = *sim.map.find(id);
      while (!p.bound.empty()) sim.edit.unbind(cam(1), sim.map.track(p.bound.front()), Why::kOddOneOut);
    }
  };
  for (int i = 0; i <= kLast; ++i) {
    sim.ingest();
    for (int c = 0; c < 2; ++c) sim.place(cam(c), transform_world(sim.truth(cam(c), at_set(i)), drift(i)));
    if (i == kMiddle) {
      for (int p = 0; p < world_.size() && visited.size() < 40; ++p) {
        if (sim.track_of(cam(1), p) == nullptr) continue;
        const MapPoint& made = sim.create(drift(i) * world_.position(p));
        sim.bind(made, cam(1), *sim.track_of(cam(1), p));
        visited.push_back(made.id);
      }
    }
    if (i == kMiddle || i == kLast) see_all();
  }
  const auto between = [&](const MapEdit& edit) { return pose(edit, 1, kLast) * pose(edit, 1, kMiddle).inverse(); };
  MapEdit edit = sim.edit;
  ASSERT_TRUE(close_loop(edit, sim.id, loop(kLast, 0), {}, {}));
  const double moved_m = (between(edit).center() - between(sim.edit).center()).norm();
  for (const PointId id : visited) {
    auto p = sim.map.find(id);
    sim.edit.forget_past(*p);  // and without the visits
  }
  MapEdit torn = sim.edit;
  ASSERT_TRUE(close_loop(torn, sim.id, loop(kLast, 0), {}, {}));
  EXPECT_LT(moved_m, 0.8 * (between(torn).center() - between(sim.edit).center()).norm());
}

TEST_F(CloseLoopTest, TheLoopHoldsAndTheDriftIsSpread) {
  const MapEdit edit = closed();
  EXPECT_THAT(pose(edit, 0, kLast), PoseNear(truth(0, kLast), 1e-9, 1e-9));
  EXPECT_THAT(pose(edit, 0, 0), PoseNear(truth(0, 0), 1e-12, 1e-12));
  const double before = (pose(sim_.edit, 0, kMiddle).center() - truth(0, kMiddle).center()).norm();
  EXPECT_LT((pose(edit, 0, kMiddle).center() - truth(0, kMiddle).center()).norm(), 0.3 * before);
  EXPECT_GT(edit.map().epoch(), sim_.map.epoch());
  EXPECT_NEAR(edit.map().camera(cam(0)).moved.scale, std::exp(-0.1), 1e-9) << "told to its agent";
  ASSERT_EQ(edit.journal().events().size(), 1U);
  const Event& e = edit.journal().events().front();
  EXPECT_EQ(std::tuple(e.kind, e.why, e.map), std::tuple(EventKind::kMapMoved, Why::kLoopClosed, sim_.id));
}

// A server that was away a second knows a camera again by what that says itself, and its depths by new points.
TEST(CloseLoop, DriftIsWhereNobodyLooked) {
  constexpr int kFrom = 30, kTo = 60, kEnd = 90;
  const test::SimWorld world{{}};
  test::SimMap sim{world, test::paths_side_by_side(1)};
  const Similarity3 after{1.5, so3_exp({0, 0.05, 0}), {0.2, 0, -0.1}};
  const auto truth = [&](int set) { return sim.truth(cam(0), at_set(set)); };
  for (int i = 0; i <= kEnd; ++i) {
    sim.ingest();
    if (i <= kFrom || i >= kTo) sim.place(cam(0), i < kTo ? truth(i) : transform_world(truth(i), after));
  }
  const LoopConstraint loop{cam(0), cam(0), at_set(kEnd), at_set(0), truth(kEnd) * truth(0).inverse(), 1 / after.scale};
  ASSERT_TRUE(close_loop(sim.edit, sim.id, loop, {}, {}));
  const auto pose = [&](int set) { return sim.map.camera(cam(0)).frame_at(at_set(set))->cam_from_world; };
  EXPECT_THAT(pose(kEnd), PoseNear(truth(kEnd), 1e-9, 1e-9));
  EXPECT_THAT(pose(kFrom), PoseNear(truth(kFrom), 0.005, 0.03));
  EXPECT_THAT(pose(kTo), PoseNear(truth(kTo), 0.005, 0.03));
}

TEST_F(CloseLoopTest, APointGoesWithTheFrameThatSawItLast) {
  const PointId seen = seen_in_the_middle(common_.front(), 1);
  const PointId unseen = sim_.create({0, 0, 4}).id;
  const PointId elsewhere = sim_.create(sim_.edit.new_map(Why::kStartedAlone, 1), {0, 0, 4}).id;
  const MapEdit edit = closed();
  const Eigen::Vector3d before = pose(sim_.edit, 0, kMiddle) * sim_.map.find(seen)->position;
  const Eigen::Vector3d after = pose(edit, 0, kMiddle) * edit.map().find(seen)->position;
  EXPECT_THAT(after, VectorNear(std::exp(-0.05) * before, 0.01)) << "half of the scale's drift";
  EXPECT_THAT(after.normalized(), VectorNear(before.normalized(), 1e-9)) << "the same pixel";
  for (const PointId id : {unseen, elsewhere}) EXPECT_EQ(edit.map().find(id)->position, sim_.map.find(id)->position);
}

TEST_F(CloseLoopTest, TenCommonPointsDrawTheOtherCameraAlong) {
  for (int i = 0; i < 9; ++i) seen_in_the_middle(common_.at(static_cast<std::size_t>(i)), 2);
  EXPECT_LT(off_m(closed(), 1, kMiddle), 1e-6);
  const PointId tenth = seen_in_the_middle(common_.at(9), 2);
  sim_.shift(*sim_.map.find(tenth), {0.3, 0, 0});
  const MapEdit edit = closed();
  EXPECT_GT(off_m(edit, 1, kMiddle), 0.5 * off_m(edit, 0, kMiddle));
  const View view = edit.map().key_views_of(*edit.map().find(tenth)).at(0);
  EXPECT_THAT(view.camera->project(view.cam_from_world * edit.map().find(tenth)->position),
              VectorNear(view.undistorted_px, 2))
      << "triangulated anew";
}

TEST_F(CloseLoopTest, WhatMovesStaysWhereItWasSeenLast) {
  const MapPoint& p = sim_.create(drift(kLast) * world_.position(common_.front()));
  for (int c = 0; c < 2; ++c) sim_.bind(p, cam(c), *sim_.track_of(cam(c), common_.front()));
  sim_.shift(p, {0.3, 0, 0});
  sim_.set_moving(p);
  const MapEdit edit = closed({}, {cam(0), cam(1)});
  const Eigen::Vector3d before = pose(sim_.edit, 0, kLast) * p.position;
  const Eigen::Vector3d after = pose(edit, 0, kLast) * edit.map().find(p.id)->position;
  EXPECT_THAT(after, VectorNear(std::exp(-0.1) * before, 1e-6)) << "not triangulated anew";
}

TEST_F(CloseLoopTest, WhatAgentsKnowOfTheirDepthsGoesWithTheScale) {
  sim_.edit.set_scene_depth(sim_.map.camera(cam(0)), 5);
  EXPECT_NEAR(closed().map().camera(cam(0)).scene_depth, 5 * std::exp(-0.1), 1e-9);
}

TEST_F(CloseLoopTest, CamerasOfTheGroupKeepHowTheySeeEachOther) {
  const auto between = [](const MapEdit& e) { return pose(e, 1, kLast) * pose(e, 0, kLast).inverse(); };
  Rigid3 expected = between(sim_.edit);
  expected.translation *= std::exp(-0.1);
  EXPECT_THAT(between(closed({}, {cam(0), cam(1)})), PoseNear(expected, 1e-9, 1e-9));
  EXPECT_GT((between(closed()).translation - expected.translation).norm(), 0.1);
}

TEST_F(CloseLoopTest, AnEarlierLoopStillHolds) {
  const auto change_m = [&](const MapEdit& e) {
    const auto step = [](const MapEdit& of) { return pose(of, 0, 15) * pose(of, 0, 5).inverse(); };
    return (step(e).translation - step(sim_.edit).translation).norm();
  };
  EXPECT_LT(change_m(closed({loop(15, 5)})), 0.3 * change_m(closed()));
}

TEST_F(CloseLoopTest, WhatIsInAnotherMapStays) {
  const MapId other = sim_.edit.new_map(Why::kStartedAlone, 1);
  sim_.place(cam(1), other, truth(1, kLast));
  for (const int p : common_) seen_in_the_middle(p, 2);
  const MapEdit edit = closed({}, {cam(0), cam(1)});
  EXPECT_EQ(off_m(edit, 1, kLast), 0);
  EXPECT_GT(off_m(edit, 1, kMiddle), 0.05) << "where it was before";
  EXPECT_EQ(edit.map().camera(cam(1)).moved.scale, 1);
}

TEST_F(CloseLoopTest, WithoutASolutionTheMapIsAsBefore) {
  MapEdit edit = sim_.edit;
  EXPECT_FALSE(close_loop(edit, MapId(99), loop(kLast, 0), {}, {})) << "nothing is in it";
  EXPECT_FALSE(close_loop(edit, sim_.id, loop(0, kLast), {}, {})) << "the first frame does not move";
  EXPECT_FALSE(close_loop(edit, sim_.id, loop(kLast, kLast + 1), {}, {})) << "there is no such frame";
  EXPECT_EQ(off_m(edit, 0, kLast), 0);
  EXPECT_EQ(edit.map().epoch(), sim_.map.epoch());
  EXPECT_TRUE(edit.journal().events().empty());
}

}  // namespace
}  // namespace coslam::close_loop_test
