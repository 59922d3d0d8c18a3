// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/motion/classify.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <random>
#include <set>
#include <vector>

#include "server/estimator/associate/verify.h"
#include "tests/support/sim_map.h"

namespace coslam::classify_test {
namespace {

constexpr CameraId kCam0(0), kCam1(1), kCam2(2);

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
  for (int i = 0; i < sim.map.camera(kCam0).frames_in(2 * config.evidence.still_s) + 2; ++i) {
    sim.advance(1, true);
    track = sim.track_of(kCam0, world_point);
    ASSERT_NE(track, nullptr);
    classify(sim.edit, sim.set, config);
  }
  EXPECT_NE(track->point, id);
  EXPECT_FALSE(track->moves());
}

// A room that is mapped, and a body of 25 points that goes in a circle in it until it is told to stand. verify() counts
// the misses, as in the server.
class ClassifyTest : public testing::Test {
 protected:
  explicit ClassifyTest(int cameras = 2, int moving_points = 25)
      : world_({.seed = 24, .points = kStatic, .moving_points = moving_points}),
        sim_(world_, test::paths_side_by_side(cameras), {.max_tracks = 400}) {
    sim_.advance(3, true);
    sim_.add_points(0.003);
  }
  ClassifyReport step() {
    look();
    sim_.take();
    sim_.place_truly();
    return judge();
  }
  void look() {
    sim_.look(true);
    if (!stands_since_ns_) return;
    for (int i = kStatic; i < world_.size(); ++i) {
      for (const MapCamera& c : sim_.map.cameras()) {
        TrackObservation* o = sim_.seen(c.id, i);
        if (o == nullptr) continue;
        const Eigen::Vector3d place = world_.position(i, *stands_since_ns_);
        const Eigen::Vector2d noise(noise_px_(random_), noise_px_(random_));
        o->undistorted_px = (c.model.project(sim_.truth(c.id, sim_.set.id) * place) + noise).cast<float>();
      }
    }
  }
  ClassifyReport judge() {
    verify(sim_.edit, sim_.set, {});
    return classify(sim_.edit, sim_.set, config_);
  }
  void stand() { stands_since_ns_ = sim_.set.t_ns; }
  // The first world point of these that all cameras follow, and that has no map point.
  int followed(int from) {
    for (int i = from; i < world_.size(); ++i) {
      if (sim_.all_follow(i) && !sim_.track_of(kCam0, i)->bound()) return i;
    }
    ADD_FAILURE() << "none";
    return from;
  }
  const MapPoint& add(int world_point, PointPhase phase) {
    return sim_.add_point(world_point, 0.01, Eigen::Vector3d::Zero(), phase);
  }
  std::vector<Event> events(PointId id, EventKind kind) const {
    std::vector<Event> out = sim_.edit.journal().events();
    std::erase_if(out, [&](const Event& e) { return e.point != id || e.kind != kind; });
    return out;
  }
  // Unbound tracks of the body in the first camera, and how many of them have that motion.
  int of_body(TrackMotion motion, int* all = nullptr) const {
    int n = 0;
    for (const auto& [id, t] : sim_.map.camera(kCam0).tracks) {
      if (t.bound() || !world_.moves(sim_.world_point(kCam0, id))) continue;
      if (all != nullptr) ++*all;
      n += t.motion == motion;
    }
    return n;
  }

  static constexpr int kStatic = 300;
  ClassifyConfig config_;
  const test::SimWorld world_;
  test::SimMap sim_;
  std::optional<TimeNs> stands_since_ns_;
  std::mt19937_64 random_{5};
  std::normal_distribution<double> noise_px_{0, 0.3};
};

TEST_F(ClassifyTest, WhatTwoCamerasSeeElsewhereAndAgreeOnMoves) {
  for (const PointPhase phase : {PointPhase::kStatic, PointPhase::kTrial}) {
    const int body_point = followed(kStatic);
    const MapPoint& p = add(body_point, phase);
    const PointId id = p.id;
    ClassifyReport report;
    for (int i = 0; i < 60 && report.uncertain == 0; ++i) report = step();
    ASSERT_NE(sim_.map.find(id), nullptr) << name_of(phase);
    EXPECT_TRUE(p.moves()) << name_of(phase);
    EXPECT_EQ(report.uncertain, 1);
    EXPECT_EQ(report.dynamic, 1);
    EXPECT_EQ(report.removed, 0);
    EXPECT_LT((p.position - world_.position(body_point, sim_.set.t_ns)).norm(), 0.15);
    const auto became = events(p.id, EventKind::kPointBecame);
    ASSERT_FALSE(became.empty());
    EXPECT_EQ(became.back().why, Why::kSeenElsewhere);
    EXPECT_EQ(became.back().figures[0], 2) << "cameras";
    for (const BoundTrack& b : p.bound) EXPECT_TRUE(sim_.map.track(b).moves());
    EXPECT_GE(events(p.id, EventKind::kTrackMissed).size(), 2U);
  }
}

TEST_F(ClassifyTest, WhereTheyDoNotAgreeThePointIsRemoved) {
  const int corner = sim_.world_point(*sim_.map.recent_points().front());
  ASSERT_TRUE(sim_.all_follow(corner));
  const MapPoint& p = *sim_.map.recent_points().front();
  const PointId id = p.id;
  sim_.trackers[0].slide(sim_.track_of(kCam0, corner)->id, {0, 3});
  sim_.trackers[1].slide(sim_.track_of(kCam1, corner)->id, {0, -3});
  ClassifyReport report;
  for (int i = 0; i < 15 && sim_.map.find(id) != nullptr; ++i) report = step();
  ASSERT_EQ(sim_.map.find(id), nullptr);
  EXPECT_EQ(report.uncertain, 1);
  EXPECT_EQ(report.removed, 1);
  EXPECT_EQ(report.dynamic, 0);
  const auto removed = events(id, EventKind::kPointRemoved);
  ASSERT_EQ(removed.size(), 1U);
  EXPECT_EQ(removed[0].why, Why::kNoOnePlace);
  EXPECT_EQ(removed[0].figures[0], 2) << "cameras";
  EXPECT_EQ(sim_.track_of(kCam0, corner)->distrusted_before, sim_.set.id.value) << "its past is not believed";
}

TEST_F(ClassifyTest, ASlidTrackLeavesItsPointAndTheOthersStay) {
  const MapPoint& p = *sim_.map.recent_points().front();
  const BoundTrack slid = p.bound[0], honest = p.bound[1];
  ASSERT_EQ(slid.camera, kCam0);
  sim_.trackers[0].slide(slid.track, {4, -2});
  ClassifyReport report;
  for (int i = 0; i < 10 && report.slid == 0; ++i) report = step();
  EXPECT_EQ(report.slid, 1);
  EXPECT_EQ(p.bound, std::vector<BoundTrack>{honest});
  const ServerTrack& track = sim_.map.camera(kCam0).tracks.at(slid.track);
  EXPECT_FALSE(track.bound());
  EXPECT_EQ(track.distrusted_before, sim_.set.id.value) << "its past is not believed";
  EXPECT_LT((p.position - world_.position(sim_.world_point(p))).norm(), 0.06) << "it was not dragged along";
  const auto unbound = events(p.id, EventKind::kTrackUnbound);
  ASSERT_EQ(unbound.size(), 1U);
  EXPECT_EQ(unbound[0].why, Why::kOutsideGate);
  EXPECT_EQ(unbound[0].figures[0], sim_.map.config().failures);
  EXPECT_GT(unbound[0].figures[1], sim_.map.config().theta) << "standard deviations";
}

TEST_F(ClassifyTest, WithoutItEveryTrackThatFailsLeavesItsPoint) {
  config_.enabled = false;
  const MapPoint& p = *sim_.map.recent_points().front();
  ASSERT_EQ(p.bound.size(), 2U);
  sim_.shift(p, {0.4, 0, 0});
  for (int i = 1; i < sim_.map.config().failures; ++i) {
    step();
    EXPECT_EQ(p.bound.size(), 2U) << "not condemned for one bad step";
  }
  EXPECT_EQ(step().slid, 2);
  EXPECT_TRUE(p.bound.empty());
  EXPECT_TRUE(p.rests());
}

TEST_F(ClassifyTest, APathBeginsWithTheFirstFailure) {
  const MapPoint& p = add(followed(kStatic), PointPhase::kStatic);
  for (int i = 0; i < 60 && !p.moves(); ++i) step();
  ASSERT_TRUE(p.moves());
  const std::vector<MotionSample>& path = sim_.map.motions().at(p.id);
  EXPECT_EQ(path.back().set, sim_.set.id);
  EXPECT_EQ(path.front().set.value + static_cast<std::uint32_t>(sim_.map.config().failures), sim_.set.id.value);
}

TEST_F(ClassifyTest, OneCameraAloneDoubtsNoPoint) {
  const MapPoint& p = *sim_.map.recent_points().front();
  const int corner = sim_.world_point(p);
  ASSERT_EQ(p.bound.size(), 2U);
  sim_.trackers[0].slide(sim_.track_of(kCam0, corner)->id, {0, 3});
  for (int i = 0; i < 15; ++i) EXPECT_EQ(step().uncertain, 0);
  EXPECT_TRUE(p.rests());
  EXPECT_FALSE(sim_.track_of(kCam0, corner)->bound()) << "it slid";
  EXPECT_TRUE(sim_.track_of(kCam1, corner)->bound());
}

TEST_F(ClassifyTest, WhatStopsIsOnTrialAndThenStatic) {
  const int body_point = followed(kStatic);
  const MapPoint& p = add(body_point, PointPhase::kMoving);
  for (int i = 0; i < 15; ++i) {
    EXPECT_EQ(step().stopped, 0);
    ASSERT_TRUE(p.moves()) << i;
  }
  stand();
  int stood = 0;
  for (; stood < 40 && p.moves(); ++stood) step();
  const int still = sim_.map.camera(kCam0).frames_in(config_.evidence.still_s);
  EXPECT_GE(stood, still - 1);
  EXPECT_LE(stood, 3 * still);
  ASSERT_EQ(p.phase, PointPhase::kTrial);
  EXPECT_EQ(events(p.id, EventKind::kPointBecame).back().why, Why::kStopped);
  EXPECT_LT((p.position - world_.position(body_point, *stands_since_ns_)).norm(), 0.15);
  EXPECT_EQ(sim_.track_of(kCam0, body_point)->motion, TrackMotion::kResting);
  for (int i = 0; i < 60 && !p.proven(); ++i) step();
  EXPECT_TRUE(p.proven());
  EXPECT_EQ(events(p.id, EventKind::kPointBecame).back().why, Why::kStoodTheTrial);
}

TEST_F(ClassifyTest, WhatGoesOnMovesUnderItsId) {
  const MapPoint& p = add(followed(kStatic), PointPhase::kMoving);
  for (int i = 0; i < 3; ++i) step();
  stand();
  for (int i = 0; i < 40 && p.moves(); ++i) step();
  ASSERT_EQ(p.phase, PointPhase::kTrial);
  stands_since_ns_.reset();
  for (int i = 0; i < 20 && !p.moves(); ++i) step();
  EXPECT_TRUE(p.moves());
}

class ClassifyWithThree : public ClassifyTest {
 protected:
  ClassifyWithThree() : ClassifyTest(3) {}
};

// Three cameras follow what does not move, the third one a corner two pixels beside it.
TEST_F(ClassifyWithThree, AStoppedPointLetsGoOfTracksOnOtherCorners) {
  const std::vector<const MapPoint*> points = sim_.map.recent_points();
  const MapPoint& known = **std::ranges::find_if(points, [](const MapPoint* q) { return q->bound.size() == 3; });
  const int corner = sim_.world_point(known);
  sim_.edit.remove_point(known, Why::kTooFewViews);
  const MapPoint& p = sim_.create(world_.position(corner), 0.01, PointPhase::kMoving);
  for (const CameraId c : {kCam0, kCam1, kCam2}) {
    const Eigen::Vector2f offset_px(c == kCam2 ? 1.5F : 0, 0);
    sim_.edit.bind_moving(p, c, *sim_.track_of(c, corner), offset_px, Why::kLooksLikeIt);
  }
  for (int i = 0; i < 5; ++i) step();
  EXPECT_TRUE(p.rests());
  EXPECT_EQ(p.bound.size(), 2U);
  EXPECT_FALSE(sim_.track_of(kCam2, corner)->bound());
  const auto unbound = events(p.id, EventKind::kTrackUnbound);
  ASSERT_EQ(unbound.size(), 1U);
  EXPECT_EQ(unbound[0].why, Why::kOtherCorner);
  EXPECT_NEAR(unbound[0].figures[0], 1.5, 1e-6);
}

TEST_F(ClassifyTest, TracksOfABodyAreDoubtedAndThenMove) {
  std::set<TrackId> doubted, moved_after_doubt;
  int all = 0;
  for (int i = 0; i < 30; ++i) {
    step();
    for (const auto& [id, t] : sim_.map.camera(kCam0).tracks) {
      if (t.motion == TrackMotion::kDoubtful) doubted.insert(id);
      if (t.moves() && doubted.contains(id)) moved_after_doubt.insert(id);
    }
  }
  EXPECT_GT(of_body(TrackMotion::kMoving, &all), 0.8 * all);
  EXPECT_GT(all, 12);
  EXPECT_GT(moved_after_doubt.size(), 5U);
  for (const auto& [id, t] : sim_.map.camera(kCam0).tracks) {
    EXPECT_TRUE(!t.moves() || world_.moves(sim_.world_point(kCam0, id))) << "nothing else";
  }
}

TEST_F(ClassifyTest, TracksThatMissTooLittleForMovingAreDoubtful) {
  config_.evidence.motion_px = 1000;
  for (int i = 0; i < 30; ++i) step();
  EXPECT_EQ(of_body(TrackMotion::kMoving), 0);
  int all = 0;
  EXPECT_GT(of_body(TrackMotion::kDoubtful, &all), 0.7 * all);
  config_ = {};
  step();
  EXPECT_GT(of_body(TrackMotion::kMoving), 0.7 * all) << "with the same past";
}

TEST_F(ClassifyTest, TracksOfABodyThatStopsRestAgain) {
  for (int i = 0; i < 30; ++i) step();
  ASSERT_GT(of_body(TrackMotion::kMoving), 10);
  stand();
  for (int i = 0; i < sim_.map.camera(kCam0).frames_in(2 * config_.evidence.still_s) + 2; ++i) step();
  int all = 0;
  EXPECT_GT(of_body(TrackMotion::kResting, &all), 0.8 * all);
}

class ClassifyWithOneMover : public ClassifyTest, public testing::WithParamInterface<bool> {
 protected:
  ClassifyWithOneMover() : ClassifyTest(2, 1) {}
};
INSTANTIATE_TEST_SUITE_P(Rooms, ClassifyWithOneMover, testing::Bool());

TEST_P(ClassifyWithOneMover, WithoutNeighboursATrackIsNotBelieved) {
  const bool room_is_mapped_there = GetParam();
  const Eigen::Vector2f there = sim_.track_of(kCam0, followed(kStatic))->seen.back().undistorted_px;
  for (const auto& [id, t] : sim_.map.camera(kCam0).tracks) {
    if (room_is_mapped_there || !t.bound() || (t.seen.back().undistorted_px - there).norm() > 150) continue;
    sim_.edit.remove_point(*sim_.map.find(t.point), Why::kTooFewViews);
  }
  for (int i = 0; i < 40; ++i) {
    step();
    EXPECT_EQ(of_body(TrackMotion::kMoving) + of_body(TrackMotion::kDoubtful), 0);
  }
  EXPECT_EQ(of_body(TrackMotion::kResting), 1) << "it is there";
}

// Corners where one thing hides another: several beside each other slide up while the camera moves sideways.
class ClassifyCorners : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Cameras, ClassifyCorners, testing::Bool());

TEST_P(ClassifyCorners, ThatSlideByAPartOfTheParallaxDoNotMove) {
  const bool hovers = GetParam();
  const test::SimWorld world({});
  const auto path = [hovers](double t_s) { return test::looking({hovers ? 0 : 0.9 * t_s - 0.5, 0, 0}); };
  test::SimMap sim(world, {path});
  sim.advance(1, true);
  const Eigen::Vector2f middle(320, 240);
  std::vector<TrackId> corners;
  for (const auto& [id, t] : sim.map.camera(kCam0).tracks) {
    if ((t.seen.back().undistorted_px - middle).norm() < 100) corners.push_back(id);
  }
  ASSERT_GT(corners.size(), 10U);
  for (const TrackId id : corners) sim.trackers[0].slide(id, {0, 0.28});
  for (int i = 0; i < world.size(); ++i) {
    const ServerTrack* t = sim.track_of(kCam0, i);
    if (t != nullptr && std::ranges::find(corners, t->id) == corners.end()) sim.add_point(i);
  }
  for (int i = 0; i < 29; ++i) {
    sim.advance(1, true);
    classify(sim.edit, sim.set, {});
  }
  int moving = 0;
  for (const TrackId id : corners) moving += sim.map.camera(kCam0).tracks.at(id).moves();
  if (hovers) {
    EXPECT_GT(moving, 0.6 * static_cast<double>(corners.size())) << "no motion of the camera explains it";
  } else {
    EXPECT_EQ(moving, 0);
  }
}

}  // namespace
}  // namespace coslam::classify_test
