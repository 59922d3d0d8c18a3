// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <vector>

#include "server/estimator/map_server.h"
#include "tests/support/sim_map.h"
#include "tests/support/sim_run.h"

// Agents that join late, stop, stall, restart and lose their way.
namespace coslam::map_server_agents_test {
namespace {

using test::SimRun;
using test::SimWorld;

CameraId cam(int i) { return CameraId(static_cast<std::uint16_t>(i)); }

bool tracked(SimRun& run, int camera) {
  const FramePose& f = run.map().camera(cam(camera)).frames.back();
  return f.set == run.map().now() && f.map == run.server().largest_map() &&
         run.agent(cam(camera)).pose_state() == PoseState::kTracked;
}

class Agents : public testing::Test {
 protected:
  void add(int count) {
    for (const auto& path : test::paths_side_by_side(count)) run_.add_agent(path);
  }
  void expect_good(double most = 0.0014) {
    const test::PathError error = run_.path_error();
    EXPECT_LT(error.ate, most * error.path_m);
  }
  const SimWorld world_{{}};
  SimRun run_{world_, {}};
};

TEST_F(Agents, ThatJoinLateArePlaced) {
  const auto paths = test::paths_side_by_side(3);
  run_.add_agent(paths[0]);
  run_.add_agent(paths[1]);
  run_.step(60);
  const CameraId late = run_.add_agent(paths[2]);
  run_.step(30);
  EXPECT_EQ(run_.map().camera(late).map, run_.map().camera(cam(0)).map);
  EXPECT_TRUE(tracked(run_, 2));
  run_.step(60);
  EXPECT_GE(run_.path_error(late).frames, 60);
  expect_good();
}

TEST_F(Agents, ThatStopDoNotStopTheOthers) {
  add(3);
  run_.step(60);
  run_.stop(cam(1));
  run_.step(60);
  EXPECT_EQ(run_.last_patches().size(), 2U);
  EXPECT_TRUE(tracked(run_, 0));
  EXPECT_TRUE(tracked(run_, 2));
  EXPECT_EQ(run_.path_error().frames, 3 * 120 - 60);
  expect_good();
}

TEST_F(Agents, AllButOneStop) {
  add(2);
  run_.step(60);
  run_.stop(cam(0));
  run_.step(120);
  EXPECT_TRUE(tracked(run_, 1));
  expect_good();
}

TEST_F(Agents, ThatStallComeBack) {
  add(2);
  run_.step(60);
  run_.stall(cam(1));
  run_.step(20);
  EXPECT_TRUE(tracked(run_, 0));
  run_.resume(cam(1));
  run_.step(40);
  EXPECT_TRUE(tracked(run_, 1));
  expect_good();
}

TEST_F(Agents, ThatRestartArePlacedInTheSameMap) {
  add(2);
  run_.step(60);
  const MapId before = run_.map().camera(cam(1)).map;
  run_.restart(cam(1));
  EXPECT_EQ(run_.map().camera(cam(1)).map, MapId());
  run_.step();
  EXPECT_EQ(run_.last_patches()[1].sequence, 1U);
  EXPECT_EQ(run_.last_patches()[1].agent_run, run_.agent(cam(1)).tracker().run());
  run_.step(30);
  EXPECT_EQ(run_.map().cameras().size(), 2U) << "it keeps its number";
  EXPECT_EQ(run_.map().camera(cam(1)).map, before);
  EXPECT_TRUE(tracked(run_, 1));
  EXPECT_TRUE(tracked(run_, 0)) << "the other did not notice";
  run_.step(30);
  EXPECT_GE(run_.path_error(cam(1)).frames, 60 + 50) << "what the old run did stays";
  expect_good();
}

TEST_F(Agents, FollowAServerThatRestarts) {
  add(2);
  run_.step(60);
  run_.restart_server();
  EXPECT_TRUE(run_.map().points().empty());
  run_.step(3);
  EXPECT_EQ(run_.agent(cam(0)).local_map().server_run(), run_.server().run());
  run_.step(30);
  EXPECT_TRUE(tracked(run_, 0));
  EXPECT_TRUE(tracked(run_, 1));
  run_.step(60);
  expect_good();
}

// Killed and started again on its map: as if nothing had been, but for what was not saved.
TEST_F(Agents, AreKnownToAServerThatWasKilled) {
  add(3);
  run_.step(60);
  run_.save();
  run_.step(20);
  run_.save();
  const std::size_t points = run_.map().points().size();
  const MapId map = run_.server().largest_map();
  run_.step(30);  // not saved
  run_.restore_server(60);
  EXPECT_EQ(run_.map().points().size(), points);
  EXPECT_EQ(run_.server().largest_map(), map);
  EXPECT_EQ(run_.map().cameras().size(), 3U);
  run_.step(10);
  for (int c = 0; c < 3; ++c) EXPECT_TRUE(tracked(run_, c)) << c;
  EXPECT_EQ(run_.server().largest_map(), map);
  EXPECT_EQ(run_.server().maps().size(), 1U);
  run_.step(60);
  EXPECT_EQ(run_.path_error().frames, 3 * (80 + 70)) << "those before are there, too";
  expect_good();
}

// They fly on while the server is down, and when it is back they see nothing of what it had put down: they are where
// they say, by points of their own, and the map goes on from there.
TEST(AgentsInFlight, GoOnWithTheMapOfAServerThatWasKilled) {
  const SimWorld world({.layout = test::Layout::kAround, .points = 2500});
  SimRun run(world, {});
  constexpr double kRound_s = 20;
  for (const double side : {0.0, 0.4}) {
    run.add_agent([=](double t_s) {
      const double a = 2 * std::numbers::pi * t_s / kRound_s;
      return test::looking({1.2 * std::sin(a) + side, 0.1 * std::sin(3 * a), 1.2 * std::cos(a)}, a);
    });
  }
  run.step(90);
  run.save();
  run.step(60);  // not saved
  run.restore_server(40);
  const MapId map = run.server().largest_map();
  run.step(4);
  EXPECT_TRUE(tracked(run, 0));
  EXPECT_TRUE(tracked(run, 1));
  EXPECT_GT(run.server().counts().events.at("on_own_word"), 0);
  run.step(100);
  EXPECT_EQ(run.server().largest_map(), map);
  EXPECT_EQ(run.server().maps().size(), 1U);
  const test::PathError error = run.path_error();
  EXPECT_GE(error.frames, 2 * (90 + 103)) << "all that it heard of, but for the first ones";
  EXPECT_LT(error.ate, 0.01 * error.path_m);
}

// Yesterday's map: other tracks, other runs; the frame and the unit of length are those of yesterday.
TEST_F(Agents, ComeBackAnotherDay) {
  add(3);
  run_.step(90);
  run_.save();
  const MapId map = run_.server().largest_map();
  for (int c = 0; c < 3; ++c) run_.restart(cam(c));
  run_.restore_server(3000);
  for (int c = 0; c < 3; ++c) EXPECT_NE(run_.server().met_since(cam(c)), SetId(0));
  run_.step(30);
  for (int c = 0; c < 3; ++c) EXPECT_EQ(run_.map().camera(cam(c)).map, map) << c;
  run_.step(60);
  EXPECT_EQ(run_.server().maps().size(), 1U);
  expect_good();
}

TEST_F(Agents, AdmittedTwiceAreTheSame) {
  add(2);
  const Hello hello = run_.agent(cam(1)).tracker().hello();
  EXPECT_EQ(run_.server().admit(hello), cam(1));
  EXPECT_EQ(run_.map().cameras().size(), 2U);
}

TEST_F(Agents, ThatAreBlindForAWhileFindBack) {
  const auto paths = test::paths_side_by_side(2);
  run_.add_agent(paths[0]);
  // From 2 s to 3.5 s it looks out of the room, where nothing is.
  run_.add_agent([path = paths[1]](double t_s) {
    return t_s < 2 || t_s > 3.5 ? path(t_s) : test::looking({0, 0, -3}, std::numbers::pi);
  });
  run_.step(60);
  EXPECT_TRUE(tracked(run_, 1));
  run_.step(35);
  EXPECT_FALSE(tracked(run_, 1));
  EXPECT_EQ(run_.map().camera(cam(1)).map, MapId()) << "it left the map";
  EXPECT_EQ(run_.agent(cam(1)).pose_state(), PoseState::kLost);
  EXPECT_EQ(run_.agent(cam(1)).local_map().size(), 0U);
  EXPECT_TRUE(tracked(run_, 0));
  run_.step(45);
  EXPECT_TRUE(tracked(run_, 1));
  EXPECT_EQ(run_.map().camera(cam(1)).map, run_.map().camera(cam(0)).map);
  run_.step(30);
  for (const FramePose& f : run_.map().camera(cam(1)).frames) {
    if (f.set.value > 62 && f.set.value < 100) {
      EXPECT_FALSE(f.valid()) << f.set.value << ": no pose rather than a wrong one";
    }
  }
}

TEST_F(Agents, ShortBlindnessCostsNoPlacing) {
  const auto paths = test::paths_side_by_side(2);
  run_.add_agent(paths[0]);
  run_.add_agent(paths[1]);
  run_.step(60);
  const long placed = run_.server().counts().events.at("placed");
  run_.stall(cam(1));
  run_.step(5);
  run_.resume(cam(1));
  run_.step(5);
  EXPECT_TRUE(tracked(run_, 1));
  EXPECT_EQ(run_.server().counts().events.at("placed"), placed);
}

// Looks to one side of the room until `turn_s`, then turns to the middle.
test::CameraPath aside(double side, double turn_s) {
  return [=](double t_s) {
    const double turned = std::min(1.0, std::max(0.0, (t_s - turn_s) / 2));
    const Eigen::Vector3d center_m(side * 0.9 + 0.6 * std::sin(1.3 * t_s + side), 0.15 * std::sin(2 * t_s),
                                   0.2 * std::sin(t_s));
    return test::looking(center_m, side * (1 - turned) * 0.9);
  };
}

class AgentsApartWorlds : public testing::TestWithParam<unsigned> {};

TEST_P(AgentsApartWorlds, MapsOfTheirOwnBecomeOne) {
  const SimWorld world({.seed = GetParam(), .points = 900});
  SimRun run(world, {});
  run.add_agent(aside(-1, 2));
  run.add_agent(aside(1, 2));
  run.step(60);
  const MapId left = run.map().camera(cam(0)).map, right = run.map().camera(cam(1)).map;
  ASSERT_NE(left, MapId());
  ASSERT_NE(right, MapId());
  ASSERT_NE(left, right);
  run.step(120);
  EXPECT_EQ(run.server().counts().merges, 1);
  EXPECT_EQ(run.map().camera(cam(0)).map, run.map().camera(cam(1)).map);
  EXPECT_TRUE(tracked(run, 0));
  EXPECT_TRUE(tracked(run, 1));
  const test::PathError error = run.path_error();
  EXPECT_GE(error.frames, 0.95 * error.all_frames) << "and their past with them";
  EXPECT_LT(error.ate, 0.0017 * error.path_m);
}

// The merge moves an agent's world under it: the pose that it publishes next is the one before, moved by the correction
// and by its own motion in between; and it goes on following what it followed.
TEST_P(AgentsApartWorlds, LivePosesFollowTheMergeAndNoTrackIsLost) {
  const SimWorld world({.seed = GetParam(), .points = 900});
  SimRun run(world, {});
  run.add_agent(aside(-1, 2));
  run.add_agent(aside(1, 2));
  run.step(60);
  struct Before {
    Rigid3 cam_from_world;
    std::set<TrackId> mapped;
    TimeNs t_ns = 0;
  };
  std::vector<Before> before(2);
  for (int i = 0; i < 120 && run.server().counts().merges == 0; ++i) {
    for (int c = 0; c < 2; ++c) {
      before[static_cast<std::size_t>(c)].mapped.clear();
      for (const auto& [id, t] : run.map().camera(cam(c)).tracks) {
        if (t.point != PointId()) before[static_cast<std::size_t>(c)].mapped.insert(id);
      }
    }
    run.step();
    for (int c = 0; c < 2; ++c) {
      Before& b = before[static_cast<std::size_t>(c)];
      b.cam_from_world = run.agent(cam(c)).pose().cam_from_world;
      b.t_ns = run.map().camera(cam(c)).frames.back().capture_ns;
    }
  }
  ASSERT_EQ(run.server().counts().merges, 1);
  std::vector<Similarity3> new_from_old;
  for (int c = 0; c < 2; ++c) {
    new_from_old.push_back(run.last_patches()[static_cast<std::size_t>(c)].new_from_old);
    int lost = 0, live = 0;
    for (const TrackId id : before[static_cast<std::size_t>(c)].mapped) {
      const auto& tracks = run.map().camera(cam(c)).tracks;
      const auto at = tracks.find(id);
      if (at == tracks.end()) continue;  // ended in the image
      ++live;
      lost += at->second.point == PointId();
    }
    EXPECT_GT(live, 50);
    EXPECT_LE(lost, live / 50) << "as in any set";
  }
  const auto turn_of = [](const Similarity3& s) { return s.rotation.angularDistance(Eigen::Quaterniond::Identity()); };
  EXPECT_GT(std::max(turn_of(new_from_old[0]), turn_of(new_from_old[1])), 0.5) << "one of them gave up its frame";
  run.step();
  const double scale = 1 / run.path_error().scale;  // map over truth
  for (int c = 0; c < 2; ++c) {
    const Before& b = before[static_cast<std::size_t>(c)];
    EXPECT_EQ(run.agent(cam(c)).pose_state(), PoseState::kTracked);
    const TimeNs now_ns = run.map().camera(cam(c)).frames.back().capture_ns;
    const Rigid3 moved = transform_world(b.cam_from_world, new_from_old[static_cast<std::size_t>(c)]);
    const Rigid3 step = run.agent(cam(c)).pose().cam_from_world * moved.inverse();
    const Rigid3 true_step = run.truth(cam(c), now_ns) * run.truth(cam(c), b.t_ns).inverse();
    EXPECT_LT(step.rotation.angularDistance(true_step.rotation), 0.005);
    EXPECT_LT((step.translation / scale - true_step.translation).norm(), 0.02) << "of 4 m to what it sees";
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, AgentsApartWorlds, testing::Range(1U, 5U));

// The first two cameras know their scale; the third's map, which has none, is the older one and the larger.
void expect_metres_stay(SimRun& run, const std::vector<test::CameraPath>& paths) {
  for (const auto& path : paths) run.add_agent(path);
  run.stall(cam(0));
  run.stall(cam(1));
  run.step(140);
  run.resume(cam(0));
  run.resume(cam(1));
  run.step(30);
  ASSERT_NE(run.map().camera(cam(2)).map, run.map().camera(cam(0)).map);
  EXPECT_TRUE(run.last_patches()[0].scale_known);
  EXPECT_FALSE(run.last_patches()[2].scale_known) << "its map has a scale of its own";
  EXPECT_EQ(run.server().largest_map(), run.map().camera(cam(2)).map);
  EXPECT_FALSE(run.server().scale_known());
  run.step(120);
  ASSERT_EQ(run.server().counts().merges, 1);
  EXPECT_TRUE(run.last_patches()[2].scale_known);
  EXPECT_TRUE(run.server().scale_known());
  EXPECT_NEAR(run.path_error().scale, 1, 0.03);
}

// Two cameras with a known baseline.
TEST(AgentsApart, MetresStayMetres) {
  const SimWorld world({.points = 900});
  const std::vector<test::CameraPath> paths{aside(0.5, 1e9), aside(1.0, 1e9), aside(-1, 5)};
  constexpr TimeNs kJoinNs = 140 * test::kPeriodNs;
  const double baseline_m = (paths[0](to_seconds(kJoinNs)).center() - paths[1](to_seconds(kJoinNs)).center()).norm();
  SimRun run(world, test::known_baseline(baseline_m));
  expect_metres_stay(run, paths);
}

// The same, with a tag that only those two see.
TEST(AgentsApart, MetresFromATagStayMetres) {
  const SimWorld world({.points = 900});
  SimRun run(world, test::known_tags(0.4));
  run.hang(TagId(1), test::tag_corners({2.3, 0, 3.2}, 0.4));
  expect_metres_stay(run, {aside(0.5, 1e9), aside(1.0, 1e9), aside(-1, 5)});
}

// Each of two maps has a tag of its own: both are metric, and so is what becomes of them.
TEST(AgentsApart, TwoMapsInMetres) {
  const SimWorld world({.points = 900});
  SimRun run(world, test::known_tags(0.4));
  run.hang(TagId(1), test::tag_corners({2.3, 0, 3.2}, 0.4));
  run.hang(TagId(2), test::tag_corners({-2.3, 0, 3.2}, 0.4));
  run.add_agent(aside(-1, 2));
  run.add_agent(aside(1, 2));
  run.step(60);
  ASSERT_NE(run.map().camera(cam(0)).map, run.map().camera(cam(1)).map);
  EXPECT_TRUE(run.last_patches()[0].scale_known);
  EXPECT_TRUE(run.last_patches()[1].scale_known);
  run.step(120);
  ASSERT_EQ(run.server().counts().merges, 1);
  EXPECT_TRUE(run.last_patches()[0].scale_known);
  EXPECT_TRUE(run.last_patches()[1].scale_known);
  EXPECT_NEAR(run.path_error().scale, 1, 0.03);
  EXPECT_TRUE(run.server().take_warnings().empty());
}

}  // namespace
}  // namespace coslam::map_server_agents_test
