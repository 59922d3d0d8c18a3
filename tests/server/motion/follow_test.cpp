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
  for (int i = 0; i <= config.forget_sets + 1; ++i) {
    world.step();
    follow_moving(world.edit(), world.set(), config);
  }
  EXPECT_EQ(world.map().find(id), nullptr);
}

}  // namespace
}  // namespace coslam
