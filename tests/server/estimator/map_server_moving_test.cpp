// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <vector>

#include "tests/support/sim_map.h"
#include "tests/support/sim_run.h"

// The whole server in a world where things move, against truth.
namespace coslam::map_server_moving_test {
namespace {

using test::SimRun;
using test::SimWorld;

// How the tracks that are at least 15 frames old are called, frame by frame.
struct Called {
  int dynamic_moving = 0, dynamic_still = 0, other_moving = 0, other_still = 0;
  double precision() const { return static_cast<double>(dynamic_moving) / (dynamic_moving + dynamic_still); }
  double recall() const { return static_cast<double>(dynamic_moving) / (dynamic_moving + other_moving); }
  double false_alarms() const { return static_cast<double>(dynamic_still) / (dynamic_still + other_still); }
};

void count(SimRun& run, const SimWorld& world, Called* called) {
  for (const MapCamera& c : run.map().cameras()) {
    for (const auto& [id, t] : c.tracks) {
      if (t.seen.size() < 15) continue;
      const MapPoint* p = run.map().find(t.point);
      const bool dynamic = p != nullptr ? p->moves() : t.moves();
      const bool moves = world.moves(run.agent(c.id).tracker().point_of(id));
      ++(moves ? (dynamic ? called->dynamic_moving : called->other_moving)
               : (dynamic ? called->dynamic_still : called->other_still));
    }
  }
}

class MovingWorld : public testing::TestWithParam<unsigned> {
 protected:
  MovingWorld() : world_({.seed = GetParam(), .points = 350, .moving_points = 100}) {}
  void add_agents(SimRun& run) const {
    for (const auto& path : test::paths_side_by_side(3)) run.add_agent(path);
  }
  // True places of what a dynamic point's tracks follow, and where the map has it now.
  std::vector<double> relative_errors(SimRun& run) const {
    const Similarity3 truth_from_map = run.path_error().truth_from_map;
    std::vector<double> errors;
    for (const auto& [id, p] : run.map().points()) {
      const int point = run.world_point(p);
      if (!p.moves() || point < 0 || p.last_seen != run.map().now()) continue;
      const Eigen::Vector3d truth = world_.position(point, run.map().now_ns());
      const double distance_m = (truth - run.truth(CameraId(0), run.map().now_ns()).center()).norm();
      errors.push_back((truth_from_map * p.position - truth).norm() / distance_m);
    }
    return errors;
  }
  // -1: stands still.
  int body_of(int point) const { return point < 0 || !world_.moves(point) ? -1 : (point - 350) / 25; }
  Eigen::Vector3d velocity_of(int body, const SimRun& run) const {
    const int point = 350 + 25 * body;
    const TimeNs now_ns = run.map().now_ns(), step_ns = to_ns(0.01);
    return (world_.position(point, now_ns + step_ns) - world_.position(point, now_ns - step_ns)) / 0.02;
  }
  const test::TrackingConfig tracking_{.outliers = 0.002, .ends = 0.004, .max_tracks = 400};
  const SimWorld world_;
};

TEST_P(MovingWorld, WhatMovesIsKnownAndFollowed) {
  SimRun run(world_, {}, tracking_);
  add_agents(run);
  run.step(45);
  Called called;
  std::vector<double> errors;
  for (int i = 0; i < 200; ++i) {
    run.step(1);
    count(run, world_, &called);
    const auto now = relative_errors(run);
    errors.insert(errors.end(), now.begin(), now.end());
  }
  EXPECT_GT(called.dynamic_moving, 10000);
  EXPECT_GT(called.precision(), 0.99);
  EXPECT_GT(called.recall(), 0.96);
  EXPECT_LT(called.false_alarms(), 0.0002);
  EXPECT_GT(errors.size(), 5000U);
  EXPECT_LT(test::median(errors), 0.02);
  const test::PathError path = run.path_error();
  EXPECT_EQ(path.frames, path.all_frames);
  EXPECT_LT(path.ate, 0.0013 * path.path_m);
  for (const MapCamera& c : run.map().cameras()) EXPECT_EQ(c.clock_offset_ns, 0);
}

TEST_P(MovingWorld, AClockThatIsHalfAFrameBehindIsFoundOut) {
  const TimeNs behind_ns = test::kPeriodNs / 2;
  const auto paths = test::paths_side_by_side(3);
  SimRun run(world_, {}, tracking_);
  for (std::size_t i = 0; i < paths.size(); ++i) run.add_agent(paths[i], i == 1 ? behind_ns : 0);
  run.step(360);
  for (std::uint16_t i = 0; i < 3; ++i) {
    const ClockOffset found = run.server().stage<ClockOffsets>().offset(CameraId(i));
    EXPECT_NEAR(found.offset_s, i == 1 ? to_seconds(behind_ns) : 0, 0.004);
    EXPECT_LT(found.sigma_s, 0.004);
  }
  EXPECT_NEAR(to_seconds(run.map().camera(CameraId(1)).clock_offset_ns), to_seconds(behind_ns), 0.004);
  std::vector<double> errors;
  for (int i = 0; i < 60; ++i) {
    run.step(1);
    const auto now = relative_errors(run);
    errors.insert(errors.end(), now.begin(), now.end());
  }
  EXPECT_LT(test::median(errors), 0.02);
}

TEST_P(MovingWorld, PathsKeepTheirIdAndAreManySamplesLong) {
  SimRun run(world_, {}, tracking_);
  add_agents(run);
  run.step(200);
  std::vector<double> lengths;
  for (const auto& [id, path] : run.map().motions()) {
    lengths.push_back(static_cast<double>(path.size()));
    for (std::size_t i = 1; i < path.size(); ++i) EXPECT_LE(path[i - 1].set, path[i].set);
  }
  EXPECT_GT(lengths.size(), 50U);
  EXPECT_GT(test::median(lengths), 60);
}

TEST_P(MovingWorld, SwitchedOffEverythingIsStatic) {
  MapServerConfig config;
  config.of<ClassifyConfig>().enabled = false;
  SimRun run(world_, config, tracking_);
  add_agents(run);
  run.step(100);
  for (const auto& [id, p] : run.map().points()) EXPECT_TRUE(p.rests());
  EXPECT_TRUE(run.map().motions().empty());
}

// Of the bodies that have at least six moving points now, how many are one object of that body alone.
struct Collected {
  int bodies = 0, as_one = 0, mixed = 0;
  std::vector<double> velocity_errors;
};

TEST_P(MovingWorld, BodiesAreObjects) {
  SimRun run(world_, test::known_baseline(1.204), tracking_);
  add_agents(run);
  run.step(60);
  Collected all;
  std::set<ObjectId> ids;
  for (int i = 0; i < 150; ++i) {
    run.step(1);
    const Similarity3 truth_from_map = run.path_error().truth_from_map;
    std::map<int, int> points;              // by body
    std::map<int, std::set<ObjectId>> own;  // objects that have points of it
    for (const auto& [id, p] : run.map().points()) {
      if (!p.moves() || run.world_point(p) < 0) continue;
      if (p.last_seen == run.map().now()) ++points[body_of(run.world_point(p))];
    }
    for (const MovingObject& o : run.server().report<ObjectsReport>().list) {
      std::map<int, std::size_t> votes;
      for (const PointId id : o.members) ++votes[body_of(run.world_point(*run.map().find(id)))];
      const auto most = std::max_element(votes.begin(), votes.end(),
                                         [](const auto& a, const auto& b) { return a.second < b.second; });
      all.mixed += std::any_of(votes.begin(), votes.end(), [&](const auto& other) {
        if (other.first == most->first) return false;
        if (other.first < 0 || most->first < 0) return true;
        // Those who go in step side by side are one.
        return (velocity_of(other.first, run) - velocity_of(most->first, run)).norm() > 0.5;
      });
      own[most->first].insert(o.id);
      ids.insert(o.id);
      const Eigen::Vector3d velocity = truth_from_map.scale * (truth_from_map.rotation * o.motion.velocity);
      if (most->first >= 0) all.velocity_errors.push_back((velocity - velocity_of(most->first, run)).norm());
    }
    for (const auto& [body, count] : points) {
      if (body < 0 || count < 6) continue;
      ++all.bodies;
      all.as_one += own[body].size() == 1;
    }
  }
  EXPECT_GT(all.bodies, 300);
  // Their circles overlap: now and then two go through each other.
  EXPECT_GT(all.as_one, 0.75 * all.bodies);
  EXPECT_LT(all.mixed, 0.15 * all.bodies);
  EXPECT_LT(test::median(all.velocity_errors), 0.2);
  EXPECT_LT(ids.size(), 12U) << "four bodies";
}

INSTANTIATE_TEST_SUITE_P(Seeds, MovingWorld, testing::Range(1U, 4U));

}  // namespace
}  // namespace coslam::map_server_moving_test
