// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/motion/follow.h"

#include <gtest/gtest.h>

#include <cmath>

#include "server/associate/patch_match.h"
#include "tests/support/sim_map.h"

namespace coslam {
namespace {

using test::kPeriodNs;

// Two cameras beside each other that move sideways, and one point that passes at walking speed, 3 m away. The second
// camera takes its images some time after the first.
class PassingPoint {
 public:
  explicit PassingPoint(TimeNs late_ns) : late_ns_(late_ns), map_(MapConfig{}), id_(map_.new_map()) {
    const CameraModel model{.width_px = 640, .height_px = 480, .fx = 450, .fy = 450, .cx = 320, .cy = 240};
    for (const char* name : {"a", "b"}) map_.add_camera(name, RunId(1), model);
    for (int i = 0; i < 3; ++i) step();
  }

  Map& map() { return map_; }
  const FrameSet& set() const { return set_; }
  static Eigen::Vector3d truth(TimeNs t_ns) { return {1.2 * to_seconds(t_ns) - 0.5, 0.1, 3.0}; }

  MapPoint& add_moving() {
    MapPoint& p = map_.create_point(id_, truth(set_.t_ns), 1e-4 * Eigen::Matrix3d::Identity(), set_.id, set_.t_ns);
    map_.set_state(p, PointState::kDynamic);
    for (MapCamera& c : map_.cameras()) bind_moving(map_, p, c.id, c.tracks.at(TrackId(1)), Eigen::Vector2f::Zero());
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
    map_.ingest(set_);
    for (MapCamera& c : map_.cameras()) {
      c.map = id_;
      c.frames.back().map = id_;
      c.frames.back().cam_from_world = pose(c.id, c.frames.back().capture_ns);
    }
  }

 private:
  static Rigid3 pose(CameraId camera, TimeNs t_ns) {
    const double x = 0.6 * camera.value + 0.3 * to_seconds(t_ns);
    return Rigid3(Eigen::Quaterniond::Identity(), Eigen::Vector3d(-x, 0, 0));
  }

  TimeNs late_ns_;
  Map map_;
  MapId id_;
  FrameSet set_;
  std::uint32_t sets_ = 0;
};

double error_m(PassingPoint& world, MapPoint& p) {
  world.step();
  const FollowReport report = follow_moving(world.map(), world.set(), {});
  EXPECT_EQ(report.positioned, 1);
  return (p.position - PassingPoint::truth(world.set().t_ns)).norm();
}

TEST(FollowMoving, IsWhereTheCamerasSeeItNow) {
  PassingPoint world(0);
  MapPoint& p = world.add_moving();
  for (int i = 0; i < 5; ++i) EXPECT_LT(error_m(world, p), 0.001);
  EXPECT_EQ(world.map().motions().at(p.id).size(), 5U);
}

TEST(FollowMoving, TracksOfACameraThatIsLateAreBroughtToTheInstantOfTheSet) {
  PassingPoint late(kPeriodNs / 2), early(-kPeriodNs / 2);
  MapPoint &p = late.add_moving(), &q = early.add_moving();
  // Taken as they are, the two pixels are 20 mm of walking apart: 0.1 m of depth.
  for (int i = 0; i < 5; ++i) {
    EXPECT_LT(error_m(late, p), 0.002);
    EXPECT_LT(error_m(early, q), 0.002);
  }
}

TEST(FollowMoving, APointSeenByOneCameraKeepsToItsRay) {
  PassingPoint world(0);
  MapPoint& p = world.add_moving();
  error_m(world, p);
  MapCamera& other = world.map().cameras()[1];
  world.map().unbind(other.id, other.tracks.at(TrackId(1)));
  const double depth = p.position.z();
  for (int i = 0; i < 5; ++i) {
    world.step();
    const FollowReport report = follow_moving(world.map(), world.set(), {});
    EXPECT_EQ(report.positioned, 0);
    EXPECT_EQ(report.carried, 1);
  }
  EXPECT_LT((p.position - PassingPoint::truth(world.set().t_ns)).norm(), 0.03);
  EXPECT_NEAR(p.position.z(), depth, 0.03);
}

TEST(FollowMoving, APointThatNobodySeesIsForgottenInTheEnd) {
  PassingPoint world(0);
  const PointId id = world.add_moving().id;
  for (MapCamera& c : world.map().cameras()) world.map().unbind(c.id, c.tracks.at(TrackId(1)));
  const FollowConfig config;
  for (int i = 0; i <= config.forget_sets + 1; ++i) {
    world.step();
    follow_moving(world.map(), world.set(), config);
  }
  EXPECT_EQ(world.map().find(id), nullptr);
}

}  // namespace
}  // namespace coslam
