// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/stages/start.h"

#include <gtest/gtest.h>

#include <vector>

#include "common/geometry/alignment.h"
#include "tests/support/matchers.h"
#include "tests/support/sim_map.h"

namespace coslam {
namespace {

using test::PoseNear;

CameraId cam(int i) { return CameraId(static_cast<std::uint16_t>(i)); }

// Poses and points of one map against truth, after the best similarity.
struct Fit {
  Similarity3 map_from_world;
  double worst_pose_m = 0, worst_pose_rad = 0;
  double median_point_m = 0;  // metres of truth
  int poses = 0, points = 0;
};

Fit fit_of(const test::SimMap& sim, MapId of) {
  Fit fit;
  std::vector<Eigen::Vector3d> truth, mapped;
  for (const auto& [id, p] : sim.map.points()) {
    const int point = sim.world_point(p);
    if (p.map != of || point < 0) continue;
    truth.push_back(sim.world.position(point));
    mapped.push_back(p.position);
  }
  fit.points = static_cast<int>(truth.size());
  const Alignment a = align_points(truth, mapped, AlignmentScale::kFree);
  if (!a.target_from_source) return fit;
  fit.map_from_world = *a.target_from_source;
  std::vector<double> errors;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    errors.push_back((mapped[i] - fit.map_from_world * truth[i]).norm() / fit.map_from_world.scale);
  }
  fit.median_point_m = test::median(errors);
  for (const MapCamera& c : sim.map.cameras()) {
    for (const FramePose& f : c.frames) {
      if (f.map != of) continue;
      const Rigid3 expected = transform_world(sim.truth(c.id, f.set), fit.map_from_world);
      const double apart = (expected.center() - f.cam_from_world.center()).norm() / fit.map_from_world.scale;
      fit.worst_pose_m = std::max(fit.worst_pose_m, apart);
      fit.worst_pose_rad = std::max(fit.worst_pose_rad, expected.rotation.angularDistance(f.cam_from_world.rotation));
      ++fit.poses;
    }
  }
  return fit;
}

class StartTest : public testing::Test {
 protected:
  explicit StartTest(int cameras = 3) : sim_(world_, test::paths_side_by_side(cameras)) {}
  StartReport step(bool descriptors) {
    sim_.ingest(false, descriptors);
    localise(sim_.map, sim_.set, config_.localise);
    return start(sim_.map, sim_.set, config_);
  }
  const MapCamera& camera(int i) const { return sim_.map.camera(cam(i)); }

  StartStageConfig config_;
  const test::SimWorld world_{{}};
  test::SimMap sim_;
};

TEST_F(StartTest, TogetherFromOneInstant) {
  for (int i = 0; i < 5; ++i) EXPECT_EQ(step(false).started, 0);
  const MapEpoch before = sim_.map.epoch();
  const StartReport report = step(true);
  ASSERT_EQ(report.started, 1);
  EXPECT_GT(sim_.map.epoch(), before);
  const MapId id = camera(0).map;
  EXPECT_NE(id, MapId());
  for (int i = 0; i < 3; ++i) EXPECT_EQ(camera(i).map, id);
  const Fit fit = fit_of(sim_, id);
  EXPECT_EQ(fit.poses, 3 * 6) << "back to the first frame";
  EXPECT_GT(fit.points, 80);
  EXPECT_LT(fit.worst_pose_m, 0.05);
  EXPECT_LT(fit.worst_pose_rad, 0.01);
  EXPECT_LT(fit.median_point_m, 0.08);
  EXPECT_TRUE(sim_.map.is_key_frame(sim_.set.id));
  for (const auto& [point_id, p] : sim_.map.points()) {
    EXPECT_GE(p.bound.size(), 2U);
    EXPECT_FALSE(p.descriptor.empty());
  }
  EXPECT_EQ(step(true).started, 0) << "once";
}

TEST_F(StartTest, AsksForDescriptorsWhileSomethingIsToBePlaced) {
  int asked = 0;
  for (int i = 0; i < 20; ++i) asked += step(false).wants_descriptors;
  EXPECT_EQ(asked, 2);
  step(true);
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(step(false).wants_descriptors) << "all are in one map";
}

TEST_F(StartTest, SaysWhyNot) {
  test::SimMap blind(
      world_, {test::still_path(test::looking({-3, 0, 4}, -1.2)), test::still_path(test::looking({3, 0, 4}, 1.2))});
  blind.ingest(false, true);
  const StartReport report = start(blind.map, blind.set, config_);
  EXPECT_EQ(report.started, 0);
  EXPECT_FALSE(report.reason.empty());
}

class StartAlone : public StartTest {
 protected:
  StartAlone() : StartTest(1) {}
};

TEST_F(StartAlone, FromItsOwnMotion) {
  int started = 0, when = 0;
  for (int i = 0; i < 40 && started == 0; ++i) {
    started = step(false).started;
    when = i;
  }
  ASSERT_EQ(started, 1);
  EXPECT_GT(when, config_.alone_after_sets);
  const Fit fit = fit_of(sim_, camera(0).map);
  EXPECT_GE(fit.poses, when) << "the way to it is found too";
  EXPECT_GT(fit.points, 40);
  // Two views a third of a metre apart: 0.1 m of depth at 6 m, and so for the place of the path in the room.
  EXPECT_LT(fit.worst_pose_m, 0.15);
  EXPECT_LT(fit.worst_pose_rad, 0.01);
  EXPECT_LT(fit.median_point_m, 0.25);
  EXPECT_GE(sim_.map.key_frames().size(), 2U);
}

TEST_F(StartAlone, NotWhileItHovers) {
  test::SimMap hovering(world_, {test::still_path(test::looking({0, 0, 0}))});
  for (int i = 0; i < 60; ++i) {
    hovering.ingest();
    ASSERT_EQ(start(hovering.map, hovering.set, config_).started, 0);
  }
}

TEST_F(StartAlone, NotFromAPureTurn) {
  for (const double rad_s : {0.1, 0.3, 0.6}) {
    test::SimMap turning(world_, {[=](double t_s) { return test::looking({0, 0, 0}, rad_s * t_s - 0.3); }});
    for (int i = 0; i < 60; ++i) {
      turning.ingest();
      ASSERT_EQ(start(turning.map, turning.set, config_).started, 0) << rad_s << ' ' << i;
    }
  }
}

TEST_F(StartTest, ALateCameraIsPlaced) {
  // Two are in a map as truth has it; the points carry descriptors.
  for (int i = 0; i < 10; ++i) {
    sim_.ingest(false, true);
    sim_.place_truly(cam(0));
    sim_.place_truly(cam(1));
    if (i > 0) continue;
    for (int p = 0; p < world_.size(); ++p) {
      if (sim_.track_of(cam(0), p) != nullptr || sim_.track_of(cam(1), p) != nullptr) sim_.add_point(p);
    }
  }
  const StartReport report = start(sim_.map, sim_.set, config_);
  EXPECT_EQ(report.placed, 1);
  EXPECT_EQ(camera(2).map, sim_.id);
  EXPECT_THAT(camera(2).frames.back().cam_from_world, PoseNear(sim_.truth(cam(2), sim_.set.id), 0.006, 0.03));
  int bound = 0;
  for (const auto& [id, t] : camera(2).tracks) {
    if (t.point == PointId()) continue;
    ++bound;
    EXPECT_EQ(sim_.world_point(*sim_.map.find(t.point)), sim_.world_point(cam(2), id));
  }
  EXPECT_GE(bound, config_.min_place_inliers);
}

TEST_F(StartTest, ACameraThatSeesSomethingElseIsNotPlaced) {
  const test::SimWorld other({.seed = 77});
  test::SimMap sim(world_, test::paths_side_by_side(2));
  test::SimTracker stranger(other, test::paths_side_by_side(1)[0], {}, "stranger", RunId(9));
  sim.ingest(false, true);
  sim.place_truly();
  sim.add_points();
  start(sim.map, sim.set, config_);  // the points get their descriptors
  sim.map.add_camera("stranger", RunId(9), test::sim_camera());
  FrameSet set{SetId(1), test::kPeriodNs, {{cam(2), stranger.observe(FrameId(0), test::kPeriodNs), {}, {}}}};
  set.frames[0].descriptors = stranger.describe(set.frames[0].frame);
  sim.map.ingest(set);
  EXPECT_EQ(start(sim.map, set, config_).placed, 0);
  EXPECT_EQ(sim.map.camera(cam(2)).map, MapId());
}

// Cameras 0 and 1 in one map, as truth has it; camera 2 in a map of its own, elsewhere and 2.5 times as large.
class MergeTest : public StartTest {
 protected:
  MergeTest() {
    for (int i = 0; i < 40; ++i) {
      sim_.ingest(false, i == 0);
      for (int c = 0; c < 2; ++c) sim_.place_truly(cam(c));
      MapCamera& c = sim_.map.camera(cam(2));
      c.map = c.frames.back().map = own_;
      c.frames.back().cam_from_world = transform_world(sim_.truth(cam(2), sim_.set.id), own_from_world_);
      if (i > 0) continue;
      start(sim_.map, sim_.set, config_);  // takes the descriptors to their tracks; nothing is there to be joined
      for (int p = 0; p < world_.size(); ++p) {
        if (sim_.track_of(cam(0), p) != nullptr || sim_.track_of(cam(1), p) != nullptr) sim_.add_point(p);
        ServerTrack* t = sim_.track_of(cam(2), p);
        if (t == nullptr) continue;
        const Eigen::Matrix3d covariance = 1e-4 * Eigen::Matrix3d::Identity();
        MapPoint& own = sim_.map.create_point(own_, own_from_world_ * world_.position(p), covariance, sim_.set.id, 0);
        sim_.map.bind(own, cam(2), *t);
      }
      sim_.map.add_key_frame(sim_.set.id);
    }
  }
  // The same, with descriptors, and the stage called.
  StartReport meet() {
    sim_.ingest(false, true);
    for (int c = 0; c < 2; ++c) sim_.place_truly(cam(c));
    MapCamera& c = sim_.map.camera(cam(2));
    c.frames.back().map = own_;
    c.frames.back().cam_from_world = transform_world(sim_.truth(cam(2), sim_.set.id), own_from_world_);
    return start(sim_.map, sim_.set, config_);
  }
  const MapId own_ = sim_.map.new_map();
  const Similarity3 own_from_world_{2.5, so3_exp({0.1, 0.8, -0.2}), {5, -2, 1}};
};

TEST_F(MergeTest, TwoMapsBecomeOneWithOneScale) {
  const MapEpoch before = sim_.map.epoch();
  EXPECT_EQ(meet().merged, 1);
  EXPECT_GT(sim_.map.epoch(), before);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(camera(i).map, sim_.id) << "the one with more frames keeps its coordinates";
  const Fit fit = fit_of(sim_, sim_.id);
  EXPECT_EQ(fit.poses, 3 * 41);
  EXPECT_NEAR(fit.map_from_world.scale, 1, 0.02);
  EXPECT_LT(fit.worst_pose_m, 0.08);
  EXPECT_LT(fit.worst_pose_rad, 0.01);
  EXPECT_LT(fit.median_point_m, 0.05);
  // The agent of camera 2 is told how its world moved: the inverse of how it was set off.
  EXPECT_NEAR(camera(2).moved.scale, 1 / 2.5, 0.02);
  EXPECT_NEAR(camera(0).moved.scale, 1, 1e-9);
}

TEST_F(MergeTest, PointsThatAreTheSameAreFused) {
  const std::size_t before = sim_.map.points().size();
  meet();
  EXPECT_LT(sim_.map.points().size(), before - 20);
  int shared = 0;
  for (const auto& [id, p] : sim_.map.points()) {
    EXPECT_EQ(p.map, sim_.id);
    int of_two = 0;
    for (const BoundTrack& b : p.bound) {
      EXPECT_EQ(sim_.map.camera(b.camera).tracks.at(b.track).point, id);
      EXPECT_EQ(sim_.world_point(b.camera, b.track), sim_.world_point(p));
      of_two += b.camera == cam(2);
    }
    shared += of_two > 0 && p.bound.size() > 1;
  }
  EXPECT_GT(shared, 25);
}

TEST_F(MergeTest, ASecondTimeThereIsNothingToMerge) {
  EXPECT_EQ(meet().merged, 1);
  sim_.ingest(false, true);
  sim_.place_truly();
  const StartReport again = start(sim_.map, sim_.set, config_);
  EXPECT_EQ(again.merged, 0);
  EXPECT_EQ(again.started, 0);
}

}  // namespace
}  // namespace coslam
