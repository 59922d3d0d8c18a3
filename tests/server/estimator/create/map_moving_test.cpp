// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/create/map_moving.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <vector>

#include "tests/support/sim_map.h"

namespace coslam::map_moving_test {
namespace {

constexpr CameraId kCam0(0), kCam1(1);

// Two cameras 1.2 m apart with true poses, whose view things cross; the first few static points that both see are
// mapped, so that they share an edge.
class MapMovingTest : public testing::Test {
 protected:
  MapMovingTest() : sim_(world_, test::paths_side_by_side(2)) {
    sim_.advance(10, true);
    for (int p = 0; p < world_.size() && sim_.map.points().size() < kSeeds; ++p) {
      if (!world_.moves(p) && sim_.all_follow(p)) sim_.add_point(p);
    }
  }
  MapMovingReport step() { return map_moving(sim_.edit, sim_.set, view_graph(sim_.map, sim_.set), {}, {}); }
  // What the first camera believes of its free tracks; the number of them that stand still.
  int believe(bool moving) {
    int still = 0;
    for (const auto& [id, t] : sim_.map.camera(kCam0).tracks) {
      if (t.bound()) continue;
      sim_.edit.set_motion(kCam0, t, moving ? TrackMotion::kMoving : TrackMotion::kResting);
      still += !world_.moves(sim_.world_point(kCam0, id));
    }
    return still;
  }

  // A world point that moves and that both cameras follow.
  int any_mover() const {
    int i = kStatic;
    while (!sim_.all_follow(i)) ++i;
    return i;
  }
  void bind(const MapPoint& point, CameraId camera, int world_point) {
    sim_.edit.bind_moving(point, camera, *sim_.track_of(camera, world_point), Eigen::Vector2f::Zero(),
                          Why::kLooksLikeIt);
  }

  static constexpr std::size_t kSeeds = 12;
  static constexpr int kStatic = 300;
  const test::SimWorld world_{{.points = kStatic, .moving_points = 80}};
  test::SimMap sim_;
};

TEST_F(MapMovingTest, NothingThatNobodySeesMove) {
  believe(false);
  EXPECT_EQ(step().joined, 0);
}

// One camera knows that they move, to the other they look like things at rest farther or nearer.
TEST_F(MapMovingTest, WhatOneCameraSeesMoveIsJoinedIfItMoves) {
  ASSERT_GT(believe(true), 20);
  EXPECT_GE(step().joined, 10);
  EXPECT_GE(sim_.map.moving_points().size(), 10U);
  for (const MapPoint* p : sim_.map.moving_points()) EXPECT_TRUE(world_.moves(sim_.world_point(*p)));
  EXPECT_EQ(sim_.map.points().size(), kSeeds + sim_.map.moving_points().size()) << "nothing else is made";
}

TEST_F(MapMovingTest, APathBeginsWhereItsTracksFirstMet) {
  believe(true);
  step();
  int whole = 0;
  for (const MapPoint* p : sim_.map.moving_points()) {
    const std::vector<MotionSample>& path = sim_.map.motions().at(p->id);
    for (std::size_t i = 1; i < path.size(); ++i) EXPECT_EQ(path[i].set.value, path[i - 1].set.value + 1);
    EXPECT_EQ(path.back().set.value + 1, sim_.set.id.value) << "where it is now is follow's affair";
    for (const MotionSample& s : path) EXPECT_EQ(s.seen.size(), 2U);
    whole += path.front().set == SetId(0);
  }
  EXPECT_GT(whole, 0.7 * static_cast<double>(sim_.map.moving_points().size())) << "both have followed it since then";
}

TEST_F(MapMovingTest, APointOfOneCameraGetsTheTrackOfTheOther) {
  believe(true);
  const int thing = any_mover();
  const MapPoint& p = sim_.create(world_.position(thing, sim_.set.t_ns), 0.02, PointPhase::kMoving);
  bind(p, kCam0, thing);
  step();
  ASSERT_EQ(p.bound.size(), 2U);
  EXPECT_EQ(sim_.track_of(kCam1, thing)->point, p.id);
  EXPECT_LT(sim_.track_of(kCam1, thing)->offset_px.norm(), 1.5) << "both follow the same corner";
}

TEST_F(MapMovingTest, TwoPointsOfOneThingBecomeOne) {
  believe(true);
  const int thing = any_mover();
  const MapPoint& p = sim_.create(world_.position(thing, sim_.set.t_ns), 0.02, PointPhase::kMoving);
  const PointId gone = sim_.create(world_.position(thing, sim_.set.t_ns), 0.02, PointPhase::kMoving).id;
  bind(p, kCam0, thing);
  bind(*sim_.map.find(gone), kCam1, thing);
  step();
  EXPECT_EQ(sim_.map.find(gone), nullptr);
  EXPECT_EQ(p.bound.size(), 2U);
  const Event fused = *std::ranges::find(sim_.edit.journal().events(), EventKind::kPointFused, &Event::kind);
  EXPECT_EQ(fused.why, Why::kOneMover);
  EXPECT_EQ(fused.point, p.id);
  EXPECT_EQ(fused.other, gone);
}

TEST_F(MapMovingTest, StaticPointsTakeNoPart) {
  believe(true);
  const int thing = any_mover();
  const MapPoint& p = sim_.create(world_.position(thing, sim_.set.t_ns));
  sim_.bind(p, kCam0, *sim_.track_of(kCam0, thing));
  step();
  EXPECT_EQ(p.bound.size(), 1U);
  EXPECT_TRUE(p.proven());
}

// The same run again, but the patches of one moving thing alone are there: in the first camera its own, in the second
// one those of a track that a test puts where it likes.
class OnePairMoving : public MapMovingTest {
 protected:
  OnePairMoving() : thing_(fastest_across()) {}
  // The mover with the largest step across the epipolar lines, which are nearly rows.
  int fastest_across() const {
    int best = any_mover();
    const auto across = [&](int i) {
      return std::abs(world_.position(i, sim_.set.t_ns).y() - world_.position(i, sim_.set.t_ns - kBackNs).y());
    };
    for (int i = kStatic; i < world_.size(); ++i) {
      if (sim_.all_follow(i) && across(i) > across(best)) best = i;
    }
    return best;
  }
  // place: of the thing as the two cameras see it, by the instant.
  MapMovingReport join(const std::function<Eigen::Vector3d(CameraId, TimeNs)>& place, bool others_mapped = false) {
    again_.emplace(world_, test::paths_side_by_side(2));
    for (int i = 0; i <= static_cast<int>(sim_.set.id.value); ++i) {
      again_->look(true);
      for (const CameraId c : {kCam0, kCam1}) {
        std::erase_if(again_->set.frames[c.value].patches->patches,
                      [&](const ImagePatch& p) { return p.track != sim_.track_of(c, thing_)->id; });
        const Eigen::Vector3d at = again_->truth(c, again_->set.id) * place(c, again_->set.t_ns);
        again_->seen(c, thing_)->undistorted_px = test::sim_camera().project(at).cast<float>();
      }
      again_->take();
      again_->place_truly();
    }
    for (const auto& [id, p] : sim_.map.points()) again_->add_point(sim_.world_point(p));
    for (int i = kStatic; i < world_.size() && others_mapped; ++i) {
      if (i != thing_ && again_->all_follow(i))
        again_->add_point(i, 0.02, Eigen::Vector3d::Zero(), PointPhase::kMoving);
    }
    again_->edit.set_motion(kCam0, *again_->track_of(kCam0, thing_), TrackMotion::kMoving);
    return map_moving(again_->edit, again_->set, view_graph(again_->map, again_->set), {}, {});
  }
  Eigen::Vector3d truth(TimeNs t_ns) const { return world_.position(thing_, t_ns); }
  // As far from the first camera as this share of its distance, all along.
  Eigen::Vector3d nearer(double share, TimeNs t_ns) const {
    const Eigen::Vector3d eye = sim_.truth(kCam0, sim_.set.id).center();
    return eye + share * (truth(t_ns) - eye);
  }

  static constexpr TimeNs kBackNs = 9 * test::kPeriodNs;
  int thing_;
  std::optional<test::SimMap> again_;
};

TEST_F(OnePairMoving, IsJoinedWhereItIsOneThing) {
  const MapMovingReport report = join([&](CameraId, TimeNs t_ns) { return truth(t_ns); });
  EXPECT_EQ(report.pairs.matched, 1);
  EXPECT_EQ(report.joined, 1);
  ASSERT_EQ(again_->map.moving_points().size(), 1U);
  const MapPoint& p = *again_->map.moving_points()[0];
  EXPECT_LT((p.position - truth(again_->set.t_ns)).norm(), 0.1);
  EXPECT_TRUE(again_->track_of(kCam1, thing_)->moves()) << "it is bound to what moves";
}

// What lies on the epipolar line now and looks alike, but goes another way.
TEST_F(OnePairMoving, IsRefusedWhenItWasNotOnTheLineBefore) {
  const TimeNs now_ns = sim_.set.t_ns;
  const MapMovingReport report = join([&](CameraId c, TimeNs t_ns) { return truth(c == kCam0 ? t_ns : now_ns); });
  EXPECT_EQ(report.pairs.matched, 1) << "now it is there";
  EXPECT_EQ(report.joined, 0);
  EXPECT_TRUE(again_->map.moving_points().empty());
}

TEST_F(OnePairMoving, IsRefusedWhenItWasElsewhereOnce) {
  const TimeNs once_ns = sim_.set.t_ns - 4 * test::kPeriodNs;
  const MapMovingReport report = join([&](CameraId c, TimeNs t_ns) {
    const Eigen::Vector3d off_m(0, c == kCam1 && t_ns == once_ns ? 0.2 : 0, 0);
    return Eigen::Vector3d(truth(t_ns) + off_m);
  });
  EXPECT_EQ(report.pairs.matched, 1);
  EXPECT_EQ(report.joined, 0);
}

TEST_F(OnePairMoving, IsRefusedFarInDepthFromWhatMovesBesideIt) {
  const auto near = [&](CameraId, TimeNs t_ns) { return nearer(0.75, t_ns); };
  EXPECT_EQ(join(near).joined, 1) << "with nothing beside it";
  const MapMovingReport report = join(near, true);
  EXPECT_EQ(report.pairs.matched, 1);
  EXPECT_EQ(report.joined, 0);
  EXPECT_EQ(join([&](CameraId, TimeNs t_ns) { return nearer(1, t_ns); }, true).joined, 1) << "among the others";
}

// It stands; one camera wrongly believes that it moves.
TEST_F(OnePairMoving, IsRefusedWhenItHasNotLeftItsPlace) {
  const TimeNs then_ns = sim_.set.t_ns;
  const MapMovingReport report = join([&](CameraId, TimeNs) { return truth(then_ns); });
  EXPECT_EQ(report.pairs.matched, 1);
  EXPECT_EQ(report.joined, 0);
}

}  // namespace
}  // namespace coslam::map_moving_test
