// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/motion/follow.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/server/estimator/motion/follow_body.h"
#include "tests/support/sim_map.h"

namespace coslam::follow_test {
namespace {

using test::kPeriodNs;

// Two cameras beside each other that move sideways, and one point that passes at walking speed, 3 m away. The second
// camera takes its images some time after the first.
class PassingPoint {
 public:
  explicit PassingPoint(TimeNs late_ns) : late_ns_(late_ns), id_(edit_.new_map(Why::kStartedTogether, 2)) {
    const CameraModel model{.width_px = 640, .height_px = 480, .fx = 450, .fy = 450, .cx = 320, .cy = 240};
    for (const char* name : {"a", "b"}) edit_.add_camera(name, RunId(1), model);
    for (int i = 0; i < 3; ++i) step();
  }

  const Map& map() { return map_; }
  MapEdit& edit() { return edit_; }
  const FrameSet& set() const { return set_; }
  static Eigen::Vector3d truth(TimeNs t_ns) { return {1.2 * to_seconds(t_ns) - 0.5, 0.1, 3.0}; }

  const MapPoint& add_moving() {
    const MapPoint& p = edit_.create_point(id_, truth(set_.t_ns), 1e-4 * Eigen::Matrix3d::Identity(),
                                           PointPhase::kMoving, Why::kMetWhileMoving);
    for (const MapCamera& c : map_.cameras()) {
      edit_.bind_moving(p, c.id, c.tracks.at(TrackId(1)), Eigen::Vector2f::Zero(), Why::kMadeFromIt);
    }
    return p;
  }

  void step() {
    ++sets_;
    set_ = {.id = SetId(sets_), .t_ns = static_cast<TimeNs>(sets_) * kPeriodNs, .frames = {}};
    for (const MapCamera& c : map_.cameras()) {
      const TimeNs t_ns = set_.t_ns + (c.id.value == 0 ? 0 : late_ns_);
      TrackFrame f{.agent = c.name, .agent_run = RunId(1), .frame = FrameId(sets_), .capture_ns = t_ns};
      f.tracks.push_back({TrackId(1), c.model.project(pose(c.id, t_ns) * truth(t_ns)).cast<float>()});
      set_.frames.push_back({c.id, f, {}, {}});
    }
    edit_.ingest(set_);
    for (const MapCamera& c : map_.cameras()) {
      edit_.place(c, set_.id, id_, pose(c.id, c.frames.back().capture_ns), Why::kStartedTogether);
    }
  }

 private:
  static Rigid3 pose(CameraId camera, TimeNs t_ns) {
    const double x = 0.6 * camera.value + 0.3 * to_seconds(t_ns);
    return Rigid3(Eigen::Quaterniond::Identity(), Eigen::Vector3d(-x, 0, 0));
  }

  TimeNs late_ns_;
  MapEdit edit_{MapConfig{}};
  const Map& map_ = edit_.map();
  MapId id_;
  FrameSet set_;
  std::uint32_t sets_ = 0;
};

double error_m(PassingPoint& world, const MapPoint& p) {
  world.step();
  const FollowReport report = follow_moving(world.edit(), world.set(), {});
  EXPECT_EQ(report.positioned, 1);
  return (p.position - PassingPoint::truth(world.set().t_ns)).norm();
}

TEST(FollowMoving, IsWhereTheCamerasSeeItNow) {
  PassingPoint world(0);
  const MapPoint& p = world.add_moving();
  for (int i = 0; i < 5; ++i) EXPECT_LT(error_m(world, p), 0.001);
  EXPECT_EQ(world.map().motions().at(p.id).size(), 5U);
}

TEST(FollowMoving, TracksOfACameraThatIsLateAreBroughtToTheInstantOfTheSet) {
  PassingPoint late(kPeriodNs / 2), early(-kPeriodNs / 2);
  const MapPoint &p = late.add_moving(), &q = early.add_moving();
  // Taken as they are, the two pixels are 20 mm of walking apart: 0.1 m of depth.
  for (int i = 0; i < 5; ++i) {
    EXPECT_LT(error_m(late, p), 0.002);
    EXPECT_LT(error_m(early, q), 0.002);
  }
}

TEST(FollowMoving, APointSeenByOneCameraKeepsToItsRay) {
  PassingPoint world(0);
  const MapPoint& p = world.add_moving();
  error_m(world, p);
  const MapCamera& other = world.map().cameras()[1];
  world.edit().unbind(other.id, other.tracks.at(TrackId(1)), Why::kOddOneOut);
  const double depth = p.position.z();
  for (int i = 0; i < 5; ++i) {
    world.step();
    const FollowReport report = follow_moving(world.edit(), world.set(), {});
    EXPECT_EQ(report.positioned, 0);
    EXPECT_EQ(report.carried, 1);
  }
  EXPECT_LT((p.position - PassingPoint::truth(world.set().t_ns)).norm(), 0.03);
  EXPECT_NEAR(p.position.z(), depth, 0.03);
}

TEST(FollowMoving, APointThatNobodySeesIsForgottenInTheEnd) {
  PassingPoint world(0);
  const PointId id = world.add_moving().id;
  for (const MapCamera& c : world.map().cameras()) {
    world.edit().unbind(c.id, c.tracks.at(TrackId(1)), Why::kOddOneOut);
  }
  const FollowConfig config;
  for (std::uint32_t i = 0; i <= world.map().sets_in(config.forget_s) + 1; ++i) {
    world.step();
    follow_moving(world.edit(), world.set(), config);
  }
  EXPECT_EQ(world.map().find(id), nullptr);
}

TEST_F(FollowBody, EveryPointIsWhereItIsNow) {
  const MapPoint& p = follow_all();
  for (int i = 0; i < 20; ++i) {
    const FollowReport report = step();
    EXPECT_EQ(report.positioned, 25);
    EXPECT_EQ(report.removed, 0);
    EXPECT_LT(error_m(p), 0.15) << "a third of a pixel at 5 m";
  }
  EXPECT_GT(travelled_m(sim_.set.t_ns - 20 * kPeriodNs), 0.1);
}

TEST_F(FollowBody, WithoutTracksItIsCarriedWithItsNeighboursInSpace) {
  const MapPoint& p = follow_all();
  step();
  unbind(kCam0, body_[0]);
  unbind(kCam1, body_[0]);
  sim_.edit.move_point(p, world_.position(body_[0], sim_.set.t_ns), p.covariance);
  const TimeNs since_ns = sim_.set.t_ns;
  const double uncertain = p.covariance.trace();
  for (int i = 0; i < 15; ++i) {
    // No flow in the images tells where it went.
    for (const CameraId c : {kCam0, kCam1}) {
      for (const int other : body_) sim_.edit.set_motion(c, track(c, other), TrackMotion::kResting);
    }
    EXPECT_EQ(step().carried, 1);
  }
  EXPECT_GT(travelled_m(since_ns), 0.15);
  EXPECT_LT(error_m(p), 0.3 * travelled_m(since_ns));
  EXPECT_GT(p.covariance.trace(), uncertain) << "the longer the less certain";
}

TEST_F(FollowBody, WithoutNeighboursInSpaceItIsCarriedByTheFlowInTheImages) {
  const MapPoint& p = follow(body_[0]);
  unbind(kCam0, body_[0]);
  unbind(kCam1, body_[0]);
  sim_.edit.move_point(p, world_.position(body_[0], sim_.set.t_ns), p.covariance);
  for (const CameraId c : {kCam0, kCam1}) {
    for (const int i : body_) sim_.edit.set_motion(c, track(c, i), TrackMotion::kMoving);
  }
  const TimeNs since_ns = sim_.set.t_ns;
  for (int i = 0; i < 15; ++i) EXPECT_EQ(step().carried, 1);
  EXPECT_GT(travelled_m(since_ns), 0.15);
  EXPECT_LT(error_m(p), 0.6 * travelled_m(since_ns));
}

TEST_F(FollowBody, WithNothingThatGoesAlongItStaysAndIsLessCertain) {
  const MapPoint& p = follow(body_[0]);
  unbind(kCam0, body_[0]);
  unbind(kCam1, body_[0]);
  for (const CameraId c : {kCam0, kCam1}) sim_.edit.set_motion(c, track(c, body_[0]), TrackMotion::kResting);
  const Eigen::Vector3d before = p.position;
  const double uncertain = p.covariance.trace();
  for (int i = 0; i < 5; ++i) EXPECT_EQ(step().carried, 1);
  EXPECT_EQ(p.position, before);
  EXPECT_GT(p.covariance.trace(), uncertain);
}

TEST_F(FollowBody, OneTrackKeepsItToItsRayAndTheNeighboursTellTheDepth) {
  const MapPoint& p = follow_all();
  step();
  unbind(kCam1, body_[0]);
  for (int i = 0; i < 15; ++i) {
    step();
    const Eigen::Vector2d px = sim_.map.camera(kCam0).model.project(sim_.truth(kCam0, sim_.set.id) * p.position);
    EXPECT_LT((px - track(kCam0, body_[0]).seen.back().undistorted_px.cast<double>()).norm(), 1e-6);
  }
  EXPECT_LT(error_m(p), 0.2);
}

TEST_F(FollowBody, ItIsForgottenSoonerWhenNothingTellsWhereItWent) {
  const PointId id = follow(body_[0]).id;
  unbind(kCam0, body_[0]);
  unbind(kCam1, body_[0]);
  for (const CameraId c : {kCam0, kCam1}) sim_.edit.set_motion(c, track(c, body_[0]), TrackMotion::kResting);
  const std::uint32_t limit = sim_.map.sets_in(config_.forget_alone_s);
  for (std::uint32_t i = 0; i < limit; ++i) EXPECT_EQ(step().removed, 0);
  EXPECT_EQ(step().removed, 1);
  EXPECT_EQ(sim_.map.find(id), nullptr);
  ASSERT_EQ(events(Why::kOutOfSight).size(), 1U);
  EXPECT_EQ(events(Why::kOutOfSight)[0].figures, (Figures{limit + 1.0, static_cast<double>(limit)}));
}

TEST_F(FollowBody, ATrackOfOneCameraKeepsItForLonger) {
  const MapPoint& p = follow(body_[0]);
  unbind(kCam1, body_[0]);
  const std::uint32_t limit = sim_.map.sets_in(config_.forget_s);
  std::uint32_t lived = 0;
  const PointId id = p.id;
  for (; lived <= limit && sim_.map.find(id) != nullptr; ++lived) {
    step();
    ASSERT_NE(sim_.track_of(kCam0, body_[0]), nullptr);
  }
  EXPECT_EQ(lived, limit + 1);
  ASSERT_EQ(events(Why::kOutOfSight).size(), 1U);
  EXPECT_EQ(events(Why::kOutOfSight)[0].figures[1], limit);
}

// Of two that disagree one is wrong: the one that does not lead to where the neighbours carry the point.
TEST_F(FollowBody, AStrayIsLetGo) {
  const MapPoint& p = follow_all();
  step();
  const BoundTrack stray{kCam1, track(kCam1, body_[0]).id};
  sim_.trackers[kCam1.value].slide(stray.track, {0, 4});
  for (int i = 0; i < 10 && p.bound.size() == 2; ++i) step();
  EXPECT_EQ(p.bound, std::vector<BoundTrack>({{kCam0, track(kCam0, body_[0]).id}}));
  ASSERT_EQ(events(Why::kStray).size(), 1U);
  EXPECT_EQ(events(Why::kStray)[0].track, stray.track);
  EXPECT_GT(events(Why::kStray)[0].figures[0], 2 * sim_.map.gate_sigma_px(sim_.map.camera(kCam1)));
  for (int i = 0; i < 5; ++i) step();
  EXPECT_LT(error_m(p), 0.2) << "it was not dragged along";
}

class FollowBodyWithThree : public FollowBody {
 protected:
  FollowBodyWithThree() : FollowBody(3) {}
};

TEST_F(FollowBodyWithThree, TheOddOneOutIsLetGo) {
  const MapPoint& p = follow(body_[0]);
  step();
  const TrackId odd = track(kCam2, body_[0]).id;
  sim_.trackers[kCam2.value].slide(odd, {0, 12});
  for (int i = 0; i < 10 && p.bound.size() == 3; ++i) EXPECT_EQ(step().positioned, 1) << "by the others";
  EXPECT_EQ(p.bound.size(), 2U);
  ASSERT_EQ(events(Why::kOddOneOut).size(), 1U);
  EXPECT_EQ(events(Why::kOddOneOut)[0].track, odd);
  EXPECT_EQ(events(Why::kOddOneOut)[0].figures[0], 2) << "others";
  EXPECT_LT(error_m(p), 0.15);
}

}  // namespace
}  // namespace coslam::follow_test
