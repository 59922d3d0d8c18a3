// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/map_server.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "common/base/error.h"
#include "tests/support/map_checks.h"
#include "tests/support/matchers.h"
#include "tests/support/sim_map.h"
#include "tests/support/sim_run.h"

// Whole simulated runs: what the map is worth. Agents that come and go are in map_server_agents_test.cpp.
namespace coslam::map_server_test {
namespace {

using test::expect_same;
using test::PoseNear;
using test::SimRun;
using test::SimWorld;

CameraId cam(int i) { return CameraId(static_cast<std::uint16_t>(i)); }

void add_agents(SimRun& run, int count) {
  for (const auto& path : test::paths_side_by_side(count)) run.add_agent(path);
}

TEST(MapServer, FindsThePathOfEveryCamera) {
  const SimWorld world({});
  SimRun run(world, {}, {.noise_px = 0.3});
  add_agents(run, 3);
  run.step(180);
  const test::PathError all = run.path_error();
  EXPECT_EQ(all.frames, all.all_frames);
  EXPECT_GT(all.path_m, 12);
  EXPECT_LT(all.ate, 0.0005 * all.path_m);
  for (int i = 0; i < 3; ++i) {
    EXPECT_LT(run.path_error(cam(i)).ate, 0.0015 * run.path_error(cam(i)).path_m) << i;
    EXPECT_EQ(run.agent(cam(i)).pose_state(), PoseState::kTracked);
  }
  EXPECT_EQ(run.server().counts().frame_sets, 180);
  EXPECT_GT(run.server().counts().refinements, 3);
  EXPECT_EQ(run.server().report<ViewGraph>().groups.size(), 1U);
  run.server().finish();
  EXPECT_LT(run.path_error().ate, 1.2 * all.ate + 1e-3) << "the last adjustment makes nothing worse";
}

TEST(MapServer, TheAgentsOwnPoseIsTheServers) {
  const SimWorld world({});
  SimRun run(world, {});
  add_agents(run, 2);
  run.step(60);
  for (int i = 0; i < 60; ++i) {
    run.step();
    for (int c = 0; c < 2; ++c) {
      const FramePose& f = run.map().camera(cam(c)).frames.back();
      ASSERT_EQ(run.agent(cam(c)).pose_state(), PoseState::kTracked);
      // The agent is one patch behind: it stands on the points of the set before, in that set's epoch.
      if (run.agent(cam(c)).local_map().epoch() != run.map().epoch()) continue;
      ASSERT_THAT(run.agent(cam(c)).pose().cam_from_world, test::PoseNear(f.cam_from_world, 0.002, 0.01));
    }
  }
}

TEST(MapServer, StandsWrongAndBrokenTracks) {
  const SimWorld world({});
  SimRun run(world, {}, {.noise_px = 0.5, .outliers = 0.03, .ends = 0.02});
  add_agents(run, 3);
  run.step(150);
  const test::PathError error = run.path_error();
  EXPECT_GE(error.frames, 0.98 * error.all_frames);
  EXPECT_LT(error.ate, 0.0013 * error.path_m);
}

// Half around, farther than its map reaches: what it sees there has no parallax, so no places, but directions.
TEST(MapServer, ACameraThatTurnsOnTheSpotStaysInItsMap) {
  static constexpr double kWay_s = 3, kTurn_s = 6, kEnd_s = 10;
  const auto path = [](double t_s) {
    const double way = std::min(t_s, kWay_s) / kWay_s, turn = std::clamp((t_s - kWay_s) / kTurn_s, 0.0, 1.0);
    return test::looking({1.5 * std::sin(0.5 * std::numbers::pi * way), 0.2 * way, 0},
                         0.5 * std::numbers::pi * (1 - std::cos(std::numbers::pi * turn)));
  };
  for (const unsigned seed : {1U, 2U, 3U}) {
    const SimWorld world({.seed = seed, .layout = test::Layout::kAround, .points = 1200});
    SimRun run(world, {});
    const CameraId camera = run.add_agent(path);
    run.step(static_cast<int>(kEnd_s * 30));
    const MapCamera& c = run.map().camera(camera);
    const FramePose *before = nullptr, *after = &c.frames.back();
    double worst_rad = 0, worst = 0;
    for (const FramePose& f : c.frames) {
      const double t_s = to_seconds(f.capture_ns);
      if (t_s < kWay_s) continue;
      ASSERT_TRUE(f.valid()) << t_s;
      EXPECT_EQ(f.map, after->map);
      if (before == nullptr) before = &f;
      const Rigid3 then = path(to_seconds(before->capture_ns)), now = path(t_s);
      const double turned = before->cam_from_world.rotation.angularDistance(f.cam_from_world.rotation);
      worst_rad = std::max(worst_rad, std::abs(turned - then.rotation.angularDistance(now.rotation)));
      worst = std::max(worst, (f.cam_from_world.center() - before->cam_from_world.center()).norm());
    }
    EXPECT_LT(worst_rad, 0.02);
    EXPECT_LT(worst, 0.01 * c.scene_depth) << "no false way";
    EXPECT_EQ(run.server().maps().size(), 1U);
    EXPECT_EQ(run.agent(camera).pose_state(), PoseState::kTracked);
  }
}

TEST(MapServer, StandsMovingThings) {
  const SimWorld world({.points = 350, .moving_points = 80});
  SimRun run(world, {});
  add_agents(run, 3);
  run.step(150);
  const test::PathError error = run.path_error();
  EXPECT_GE(error.frames, 0.98 * error.all_frames);
  EXPECT_LT(error.ate, 0.0006 * error.path_m);
  // A static map point that follows a moving thing would drag poses along.
  int on_static = 0, on_moving = 0;
  for (const auto& [id, p] : run.map().points()) {
    const int point = run.world_point(p);
    if (p.bound.empty() || p.moves() || point < 0) continue;
    ++(world.moves(point) ? on_moving : on_static);
  }
  EXPECT_GT(on_static, 150);
  EXPECT_LT(on_moving, 0.1 * on_static);
}

TEST(MapServer, CovariancesAreHonestAllAlong) {
  const SimWorld world({});
  SimRun run(world, {}, {.noise_px = 0.5});
  add_agents(run, 3);
  for (int i = 0; i < 5; ++i) {
    run.step(50);
    const std::vector<double> values = run.point_nees();
    EXPECT_GT(values.size(), 200U);
    // 2.4 when all is right; smaller here, where the noise of a track's views is independent and the covariance does
    // not count on that. What it must be on real-looking images, `coslam eval` tells.
    EXPECT_GT(test::median(values), 0.1) << run.map().now().value;
    EXPECT_LT(test::median(values), 1.8) << run.map().now().value;
  }
}

TEST(MapServer, TwoRunsAreTheSameToTheBit) {
  const SimWorld world({.moving_points = 20});
  const test::TrackingConfig tracking{.outliers = 0.02, .ends = 0.01};
  SimRun first(world, {}, tracking), second(world, {}, tracking);
  add_agents(first, 3);
  add_agents(second, 3);
  std::vector<std::vector<char>> garbage;  // the heap must not show
  for (int i = 0; i < 60; ++i) {
    first.step(2);
    garbage.emplace_back(1000 + 777 * static_cast<std::size_t>(i % 13), static_cast<char>(i));
    second.step(2);
    expect_same(first.map(), second.map());
    if (HasFatalFailure()) break;
  }
  first.server().finish();
  second.server().finish();
  expect_same(first.map(), second.map());
}

struct Carried {
  std::size_t points = 0, longest_track = 0, most_patches = 0;
};

Carried carried(const Map& map) {
  Carried out{.points = map.points().size()};
  for (const auto& [id, p] : map.points()) out.most_patches = std::max(out.most_patches, p.patches.size());
  for (const MapCamera& c : map.cameras()) {
    for (const auto& [id, t] : c.tracks) out.longest_track = std::max(out.longest_track, t.seen.size());
  }
  return out;
}

TEST(MapServer, MemoryIsBoundedInOneRoom) {
  const SimWorld world({});
  SimRun run(world, {}, {.ends = 0.005});
  add_agents(run, 2);
  run.step(300);
  const Carried before = carried(run.map());
  EXPECT_LT(before.points, 3U * static_cast<std::size_t>(world.size()));
  run.step(400);
  const Carried after = carried(run.map());
  EXPECT_LT(after.points, 1.05 * static_cast<double>(before.points)) << "what is seen again is known again";
  EXPECT_LE(after.longest_track, 256U);
  EXPECT_LE(after.most_patches, 12U);
}

TEST(MapServer, AKnownBaselineGivesMetres) {
  const SimWorld world({});
  const auto paths = test::paths_side_by_side(2);
  const double baseline_m = (paths[0](0).center() - paths[1](0).center()).norm();
  SimRun run(world, test::known_baseline(baseline_m));
  for (const auto& path : paths) run.add_agent(path);
  run.step(90);
  EXPECT_TRUE(run.server().scale_known());
  EXPECT_TRUE(run.last_patches().at(0).scale_known);
  EXPECT_NEAR(run.path_error().scale, 1, 0.01);
  SimRun unscaled(world, {});
  for (const auto& path : paths) unscaled.add_agent(path);
  unscaled.step(30);
  EXPECT_FALSE(unscaled.last_patches().at(0).scale_known);
}

// Two cameras on one body, the second one 0.4 m to the right of the first.
class RigRun : public testing::Test {
 protected:
  static const Rigid3& right_from_left() {
    static const Rigid3 kRight{so3_exp({0.01, -0.05, 0.02}), {-0.4, 0.01, 0.02}};
    return kRight;
  }
  RigRun() : left_(test::paths_side_by_side(2)[0]) {
    const RigCamera camera{"cam1", "cam0", right_from_left()};
    config_.map.rigs = {text_of(camera)};
  }
  test::CameraPath right() const {
    return [left = left_](double t_s) { return right_from_left() * left(t_s); };
  }
  // Of the newest frames.
  static Rigid3 relative(const Map& map) {
    return map.camera(CameraId(1)).frames.back().cam_from_world *
           map.camera(CameraId(0)).frames.back().cam_from_world.inverse();
  }

  const SimWorld world_{{}};
  const test::CameraPath left_;
  MapServerConfig config_;
};

TEST_F(RigRun, TellsMetresAndStaysAsItIs) {
  SimRun run(world_, config_);
  run.add_agent(left_);
  run.add_agent(right());
  for (int i = 0; i < 120; ++i) {
    run.step();
    if (i < 30) continue;
    ASSERT_TRUE(run.map().camera(CameraId(1)).frames.back().valid()) << i;
    EXPECT_THAT(relative(run.map()), PoseNear(right_from_left(), 1e-9, 1e-9));
  }
  EXPECT_TRUE(run.server().scale_known());
  run.server().finish();
  EXPECT_NEAR(run.path_error().scale, 1, 0.01);
  EXPECT_LT(run.path_error().ate, 0.01 * run.path_error().path_m);
}

TEST_F(RigRun, ACameraThatComesLateIsWhereTheRigHasIt) {
  SimRun run(world_, config_);
  run.add_agent(left_);
  run.step(60);
  run.add_agent(right());
  run.step(60);
  const MapCamera& late = run.map().camera(CameraId(1));
  EXPECT_EQ(late.map, run.map().camera(CameraId(0)).map);
  ASSERT_TRUE(late.frames.back().valid());
  EXPECT_THAT(relative(run.map()), PoseNear(right_from_left(), 1e-6, 1e-6));
  EXPECT_TRUE(run.server().scale_known());
  EXPECT_NEAR(run.path_error().scale, 1, 0.02);
}

TEST_F(RigRun, IsLeftAsideWhereTheImagesContradictIt) {
  config_.map.rigs = {text_of({"cam1", "cam0", right_from_left().inverse()})};
  SimRun run(world_, config_);
  run.add_agent(left_);
  run.add_agent(right());
  run.step(90);
  EXPECT_FALSE(run.server().scale_known());
  EXPECT_THAT(
      run.server().take_warnings(),
      testing::Contains(testing::AllOf(
          testing::HasSubstr("the rig has cam1 left, turned by 3 degrees against cam0, the images have it right"),
          testing::HasSubstr("it is the inverse of what is expected"))));
  run.server().finish();
  EXPECT_LT(run.path_error().ate, 0.02 * run.path_error().path_m);
}

TEST_F(RigRun, ThatIsNotInMetresIsDoubted) {
  config_.map.rigs = {text_of({"cam1", "cam0", {right_from_left().rotation, 1000 * right_from_left().translation}})};
  SimRun run(world_, config_);
  run.add_agent(left_);
  run.add_agent(right());
  run.step(3);
  EXPECT_THAT(run.server().take_warnings(),
              testing::ElementsAre(testing::HasSubstr("the rig has cam1 401 m from cam0: metres are expected")));
}

TEST(MapServer, ARigThatIsNoneIsRefused) {
  MapServerConfig config;
  config.map.rigs = {"cam1 cam0 1 2 3"};
  EXPECT_THROW(MapServer(RunId(1), config), UserError);
}

TEST(MapServer, ATagGivesMetresToASingleCamera) {
  const SimWorld world({});
  SimRun run(world, test::known_tags(0.4));
  run.hang(TagId(5), test::tag_corners({0.5, -0.3, 3.5}, 0.4));
  run.add_agent(test::paths_side_by_side(2)[0]);
  int known = 0;
  for (int i = 0; i < 120; ++i) {
    run.step();
    known += run.last_patches().at(0).scale_known ? 1 : 0;
  }
  EXPECT_GT(known, 60) << "as soon as it is certain enough";
  EXPECT_LT(known, 115) << "not before the camera has moved";
  EXPECT_NEAR(run.path_error().scale, 1, 0.03);
  run.server().finish();
  EXPECT_TRUE(run.server().scale_known());
  EXPECT_NEAR(run.path_error().scale, 1, 0.01);
  const auto tags = run.server().stage<Scale>().tags().tags(run.server().largest_map());
  ASSERT_EQ(tags.size(), 1U);
  EXPECT_NEAR(tags[0].size.side, 0.4, 1e-6);
  EXPECT_TRUE(run.server().take_warnings().empty());
}

TEST(MapServer, TagsThatDisagreeGiveNone) {
  const SimWorld world({});
  const auto warning = [&](const auto& hang) {
    SimRun run(world, test::known_tags(0.4));
    hang(run);
    run.add_agent(test::paths_side_by_side(2)[0]);
    run.step(120);
    run.server().finish();
    EXPECT_FALSE(run.server().scale_known());
    EXPECT_FALSE(run.last_patches().at(0).scale_known);
    const auto warnings = run.server().take_warnings();
    return warnings.size() == 1 ? warnings[0] : std::to_string(warnings.size()) + " warnings";
  };
  EXPECT_THAT(warning([](SimRun& run) {
                run.hang(TagId(5), test::tag_corners({0.5, -0.3, 3.5}, 0.4));
                run.hang(TagId(6), test::tag_corners({-0.7, 0.2, 3.2}, 0.3));
              }),
              testing::HasSubstr("tag 5 is larger than tag 6, though all should be of one size"));
  EXPECT_THAT(warning([](SimRun& run) {
                run.hang(TagId(5), test::tag_corners({0.5, -0.3, 3.5}, 0.4));
                run.hang(TagId(5), test::tag_corners({-0.7, 0.2, 3.2}, 0.4));
              }),
              testing::HasSubstr("tag 5 is printed twice"));
}

TEST(MapServer, OnePatchForEachFrameOfTheSet) {
  const SimWorld world({});
  SimRun run(world, {});
  add_agents(run, 3);
  for (std::uint32_t i = 0; i < 40; ++i) {
    run.step();
    ASSERT_EQ(run.last_patches().size(), 3U);
    for (int c = 0; c < 3; ++c) {
      const MapPatch& p = run.last_patches()[static_cast<std::size_t>(c)];
      EXPECT_EQ(p.agent, run.map().camera(cam(c)).name);
      EXPECT_EQ(p.agent_run, run.map().camera(cam(c)).run);
      EXPECT_EQ(p.server_run, run.server().run());
      EXPECT_EQ(p.sequence, i + 1);
      EXPECT_EQ(p.after_frame, FrameId(i));
    }
  }
  EXPECT_EQ(run.last_patches()[0].group, run.last_patches()[2].group);
}

TEST(MapServer, OneRefinementAtATime) {
  const SimWorld world({});
  test::SimTracker left(world, test::paths_side_by_side(2)[0], {}, "left", RunId(1));
  test::SimTracker right(world, test::paths_side_by_side(2)[1], {}, "right", RunId(2));
  MapServer server(RunId(7), {});
  server.admit(left.hello());
  server.admit(right.hello());
  int jobs = 0;
  std::optional<RefineJob> kept;
  for (std::uint32_t i = 0; i < 90; ++i) {
    FrameSet set{SetId(i), test::kPeriodNs * i, {}};
    for (test::SimTracker* t : {&left, &right}) {
      CameraFrame& cf = set.frames.emplace_back();
      cf.camera = cam(t == &left ? 0 : 1);
      cf.frame = t->observe(FrameId(i), set.t_ns);
      if (i == 5) cf.descriptors = t->describe(cf.frame);
    }
    server.step(set);
    if (auto job = server.take_refine_job()) {
      ++jobs;
      kept = std::move(job);
    }
  }
  EXPECT_EQ(jobs, 1) << "its solution never came";
  ASSERT_TRUE(kept);
  const BundleResult solved = solve_refine(*kept);
  server.give_refined(std::move(*kept), solved);
  EXPECT_EQ(server.counts().refinements, 1);
  server.finish();
  EXPECT_EQ(server.counts().events.at("refine_applied"), 1);
}

}  // namespace
}  // namespace coslam::map_server_test
