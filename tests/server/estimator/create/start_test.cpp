// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/create/start.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "tests/support/map_fit.h"
#include "tests/support/sim_map.h"

namespace coslam::start_test {
namespace {

using test::cam;
using test::Fit;
using test::fit_of;

class StartTest : public testing::Test {
 protected:
  explicit StartTest(int cameras = 3) : sim_(world_, test::paths_side_by_side(cameras)) {}
  StartReport step(bool descriptors) {
    sim_.ingest(false, descriptors);
    localise(sim_.edit, sim_.set, {});
    return stage_.run(sim_.edit, sim_.set, {}, {});
  }
  const MapCamera& camera(int i) const { return sim_.map.camera(cam(i)); }

  Start stage_{StartStageConfig()};
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
  }
  EXPECT_EQ(step(true).started, 0) << "once";
}

TEST_F(StartTest, EarlierFramesAreLocalisedAsConfigured) {
  for (int i = 0; i < 5; ++i) step(false);
  sim_.ingest(false, true);
  const LocaliseConfig never{.min_inliers = 100'000};
  ASSERT_EQ(stage_.run(sim_.edit, sim_.set, never, {}).started, 1);
  EXPECT_EQ(fit_of(sim_, camera(0).map).poses, 3) << "only those of the start itself";
}

// As on a busy machine: each describes an image of its own, when it comes to it.
class StartOneAfterTheOther : public StartTest {
 protected:
  StartReport step_with(const std::vector<int>& described) {
    sim_.look(false, true);
    for (CameraFrame& cf : sim_.set.frames) {
      if (std::ranges::find(described, static_cast<int>(cf.camera.value)) == described.end()) cf.descriptors.reset();
    }
    sim_.take();
    return stage_.run(sim_.edit, sim_.set, {}, {});
  }
  int placed() const {
    return static_cast<int>(
        std::ranges::count_if(sim_.map.cameras(), [](const MapCamera& c) { return c.map != MapId(); }));
  }
};

TEST_F(StartOneAfterTheOther, StartsWhenAllHaveAnswered) {
  for (int i = 0; i < 3; ++i) EXPECT_EQ(step_with({}).started, 0);
  EXPECT_EQ(step_with({1}).started, 0);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(step_with({}).started, 0);
  EXPECT_EQ(step_with({0}).started, 0);
  EXPECT_EQ(step_with({}).started, 0);
  EXPECT_EQ(step_with({2}).started, 1);
  EXPECT_EQ(placed(), 3);
  const Fit fit = fit_of(sim_, camera(0).map);
  EXPECT_EQ(fit.poses, 3 * 11);
  EXPECT_GT(fit.points, 60) << "by tracks that live since they were described";
  EXPECT_LT(fit.worst_pose_m, 0.06);
}

// Who works on its answer sends no frame meanwhile.
TEST_F(StartOneAfterTheOther, WaitsForOneThatIsNotInTheSetToo) {
  step_with({1});
  step_with({2});
  for (int i = 0; i < 4; ++i) {
    sim_.look();
    std::erase_if(sim_.set.frames, [](const CameraFrame& cf) { return cf.camera == cam(0); });
    sim_.take();
    ASSERT_EQ(stage_.run(sim_.edit, sim_.set, {}, {}).started, 0);
  }
  EXPECT_EQ(step_with({0}).started, 1);
  EXPECT_EQ(placed(), 3);
}

// Its tracks have other numbers.
TEST_F(StartOneAfterTheOther, WhatAnAgentSaidBeforeItBeganAgainIsForgotten) {
  step_with({0});
  sim_.edit.restart_camera(cam(0), RunId{77}, camera(0).model);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(step_with({1, 2}).started, 0) << "the first has to answer again";
}

TEST_F(StartOneAfterTheOther, GoesAheadWithoutWhoSaysNothing) {
  step_with({0, 1});
  int sets = 0, started = 0;
  while (started == 0 && sets < 60) {
    started = step_with({}).started;
    ++sets;
  }
  EXPECT_EQ(started, 1);
  EXPECT_NEAR(sets, 30, 2) << "after a second";
  EXPECT_EQ(placed(), 2);
}

TEST_F(StartOneAfterTheOther, NobodyStartsAloneMeanwhile) {
  for (int i = 0; i < 25; ++i) ASSERT_EQ(step_with(i == 2 ? std::vector<int>{0, 1} : std::vector<int>{}).started, 0);
  EXPECT_EQ(placed(), 0);
}

TEST_F(StartTest, SaysWhyNot) {
  test::SimMap blind(
      world_, {test::still_path(test::looking({-3, 0, 4}, -1.2)), test::still_path(test::looking({3, 0, 4}, 1.2))});
  blind.ingest(false, true);
  const StartReport report = stage_.run(blind.edit, blind.set, {}, {});
  EXPECT_EQ(report.started, 0);
  EXPECT_FALSE(report.reason.empty());
}

// A quarter of a metre apart, going on for a fifth of a second before they start.
class StartSideBySide : public StartTest {
 protected:
  static constexpr double kApart_m = 0.25;
  void start_going(double speed_m_s, const BundleAdjustmentConfig& refine = {}) {
    const auto goes = [=](double right_m) {
      return [=](double t_s) { return test::looking({right_m, 0, speed_m_s * t_s - 1}); };
    };
    sim_.emplace(world_, std::vector<test::CameraPath>{goes(0), goes(kApart_m)});
    for (int i = 0; i < 6; ++i) sim_->ingest();
    sim_->ingest(false, true);
    ASSERT_EQ(stage_.run(sim_->edit, sim_->set, {}, refine).started, 1);
  }
  // How far the way between them points off, radians.
  double way_off() const {
    const Rigid3 second_from_first =
        camera(1).frames.back().cam_from_world * camera(0).frames.back().cam_from_world.inverse();
    return (second_from_first.center().normalized() - Eigen::Vector3d::UnitX()).norm();
  }
  const MapCamera& camera(int i) const { return sim_->map.camera(cam(i)); }

  std::optional<test::SimMap> sim_;
};

TEST_F(StartSideBySide, TheirWaySettlesHowTheyStand) {
  start_going(3);
  EXPECT_EQ(fit_of(*sim_, camera(0).map).poses, std::ssize(camera(0).frames) + std::ssize(camera(1).frames));
  EXPECT_GE(sim_->map.key_frames().size(), 3U);
  EXPECT_LT(way_off(), 0.05);
  const double adjusted = way_off();
  start_going(3, {.final_iterations = 1});
  EXPECT_NE(way_off(), adjusted) << "adjusted as configured";
}

TEST_F(StartSideBySide, ALittleWayTellsNothing) {
  start_going(0.2);
  EXPECT_EQ(sim_->map.key_frames().size(), 1U);
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
  EXPECT_GT(when, camera(0).frames_in(stage_.config.alone_after_s));
  const Fit fit = fit_of(sim_, camera(0).map);
  EXPECT_GE(fit.poses, when) << "the way to it is found too";
  EXPECT_GT(fit.points, 40);
  // Two views a third of a metre apart: 0.1 m of depth at 6 m, and so for the place of the path in the room.
  EXPECT_LT(fit.worst_pose_m, 0.15);
  EXPECT_LT(fit.worst_pose_rad, 0.01);
  EXPECT_LT(fit.median_point_m, 0.25);
  EXPECT_GE(sim_.map.key_frames().size(), 2U);
}

TEST_F(StartAlone, IsAdjustedAsConfigured) {
  const auto path_with = [&](const BundleAdjustmentConfig& refine) {
    test::SimMap sim(world_, {test::paths_side_by_side(1)[0]});
    bool started = false;
    for (int i = 0; i < 40 && !started; ++i) {
      sim.ingest();
      started = stage_.run(sim.edit, sim.set, {}, refine).started == 1;
    }
    EXPECT_TRUE(started);
    return sim.map.cameras()[0].frames.back().cam_from_world.center();
  };
  EXPECT_NE(path_with({.final_iterations = 1}), path_with({.final_iterations = 40}));
}

TEST_F(StartAlone, NotWhileItHovers) {
  test::SimMap hovering(world_, {test::still_path(test::looking({0, 0, 0}))});
  for (int i = 0; i < 60; ++i) {
    hovering.ingest();
    ASSERT_EQ(stage_.run(hovering.edit, hovering.set, {}, {}).started, 0);
  }
}

TEST_F(StartAlone, NotFromAPureTurn) {
  for (const double rad_s : {0.1, 0.3, 0.6}) {
    test::SimMap turning(world_, {[=](double t_s) { return test::looking({0, 0, 0}, rad_s * t_s - 0.3); }});
    for (int i = 0; i < 60; ++i) {
      turning.ingest();
      ASSERT_EQ(Start(StartStageConfig()).run(turning.edit, turning.set, {}, {}).started, 0) << rad_s << ' ' << i;
    }
  }
}

}  // namespace
}  // namespace coslam::start_test
