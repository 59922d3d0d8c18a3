// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/publish/watch.h"

#include <gmock/gmock.h>

#include "tests/support/sim_map.h"
#include "tests/support/sim_run.h"

namespace coslam::watch_test {
namespace {

LoopFacts facts_of(const Map& map) {
  LoopFacts out;
  for (const MapCamera& c : map.cameras()) out.agents.push_back({.name = c.name, .camera = c.id});
  out.at_work = true;
  return out;
}

class WatchTest : public ::testing::Test {
 protected:
  WatchTest() {
    for (const auto& path : test::paths_side_by_side(2)) run_.add_agent(path);
  }
  // A frame set each 33 ms of the clock.
  Snapshot step(PartSet wanted) {
    run_.step();
    now_ns_ += test::kPeriodNs;
    return watch_.after_set(run_.last_set(), run_.server(), wanted, now_ns_, [&] { return facts_of(run_.map()); });
  }
  Snapshot steps(int sets, PartSet wanted) {
    Snapshot all;
    for (int i = 0; i < sets; ++i) all.update(step(wanted));
    return all;
  }

  const test::SimWorld world_{{.points = 350, .moving_points = 100}};
  test::SimRun run_{world_, test::known_baseline(1.204), {.max_tracks = 400}};
  TimeNs now_ns_ = 1'000'000'000;
  MapWatch watch_{run_.server()};
};

TEST_F(WatchTest, CopiesWhatTheMapHas) {
  const Snapshot s = steps(150, kAllParts);
  ASSERT_TRUE(s.poses && s.moving && s.cloud && s.paths && s.tracks && s.state);
  EXPECT_EQ(s.poses->cameras.size(), 2U);
  EXPECT_EQ(s.poses->t_ns, run_.map().now_ns());
  EXPECT_NE(s.poses->main, MapId());
  const PublicPose& pose = s.poses->cameras[1];
  EXPECT_EQ(pose.agent, "cam1");
  EXPECT_TRUE(pose.covariance);
  const Rigid3& now = run_.map().cameras()[1].frames.back().cam_from_world;
  EXPECT_EQ(pose.cam_from_map.translation, now.translation);
  EXPECT_GT(s.cloud->points.size(), 100U);
  ASSERT_TRUE(s.moving->maps.contains(s.moving->main));
  EXPECT_GT(s.moving->maps.at(s.moving->main).points.size(), 3U);
  EXPECT_GT(s.paths->cameras.at(0).cam_from_map.size(), 100U);
  const auto& keys = s.paths->cameras.at(0).key_cam_from_map;
  EXPECT_GT(keys.size(), 2U);
  EXPECT_LE(keys.size(), s.state->key_frames);
  EXPECT_EQ(
      std::ranges::count_if(s.paths->cameras.at(0).cam_from_map,
                            [&](const auto& each) { return each.second.translation == keys.front().translation; }),
      1)
      << "key frames lie on the path";
  EXPECT_GT(s.tracks->cameras.at(0).tracks.size(), 100U);
  EXPECT_EQ(s.state->agents.at(0).standing, PublicStanding::kTracking);
  EXPECT_EQ(s.state->agents.at(0).why, "");
  EXPECT_NEAR(s.state->agents.at(0).rate_hz, 30, 0.1);
  EXPECT_EQ(s.state->agents.at(0).frames_due, s.state->agents.at(0).frames_used);
  EXPECT_TRUE(s.state->scale_known);
  EXPECT_GT(s.state->agents.at(0).bound, 50U);
  std::set<std::string> kinds;
  for (const PublicEvent& e : s.events) kinds.insert(e.kind);
  EXPECT_THAT(kinds, ::testing::IsSupersetOf({"joined", "map_started", "merge"}));
}

TEST_F(WatchTest, TheOdomFrameFollowsTheCameraWithoutAJump) {
  std::map<std::string, std::vector<Rigid3>> map_from_odom;
  for (int i = 0; i < 150; ++i) {
    const Snapshot s = step(i % 50 < 25 ? kAllParts : PartSet{});  // there is not always somebody who looks
    if (!s.poses) continue;
    for (const PublicPose& pose : s.poses->cameras)
      map_from_odom[pose.agent].push_back(pose.cam_from_map.inverse() * pose.cam_from_odom);
  }
  ASSERT_EQ(map_from_odom.size(), 2U);
  for (const auto& [agent, frames] : map_from_odom) {
    ASSERT_GT(frames.size(), 60U) << agent;
    // Only what was corrected meanwhile moves it: little, of metres.
    const Vector6d moved = local(frames.front(), frames.back());
    EXPECT_LT(moved.head<3>().norm(), 0.02) << agent;
    EXPECT_LT((frames.front().translation - frames.back().translation).norm(), 0.1) << agent;
  }
}

// The camera frame has x to the right, y down, z forward.
TEST_F(WatchTest, TheVelocityIsThatOfTheCamera) {
  const Snapshot s = steps(60, kAllParts);
  ASSERT_TRUE(s.poses->cameras[0].velocity);
  const PublicVelocity& v = *s.poses->cameras[0].velocity;
  const auto& frames = run_.map().cameras()[0].frames;
  const Rigid3& now = frames.back().cam_from_world;
  // Where the camera was before, seen from now, is behind by what it moved.
  const FramePose& before = frames[frames.size() - 4];
  const double over_s = to_seconds(frames.back().capture_ns - before.capture_ns);
  EXPECT_EQ(v.over_s, over_s);
  EXPECT_LT((now * before.cam_from_world.center() + v.linear * v.over_s).norm(), 1e-9);
  const Eigen::Vector3d turned = so3_log(before.cam_from_world.rotation * now.rotation.conjugate());
  EXPECT_LT((v.angular_rad * v.over_s - turned).norm(), 1e-9);
}

TEST_F(WatchTest, CopiesNothingThatNobodyWants) {
  const Snapshot s = steps(60, {});
  EXPECT_FALSE(s.poses || s.moving || s.cloud || s.paths || s.tracks);
  EXPECT_TRUE(s.state) << "for those who ask from time to time";
  EXPECT_FALSE(s.events.empty()) << "they come once only";
}

TEST_F(WatchTest, KeepsItsPace) {
  std::map<std::string, int> times;
  for (int i = 0; i < 90; ++i) {
    const Snapshot s = step(kAllParts);
    times["poses"] += s.poses ? 1 : 0;
    times["moving"] += s.moving ? 1 : 0;
    times["tracks"] += s.tracks ? 1 : 0;
    times["paths"] += s.paths ? 1 : 0;
    times["cloud"] += s.cloud ? 1 : 0;
    times["state"] += s.state ? 1 : 0;
  }
  EXPECT_EQ(times["poses"], 90);
  EXPECT_NEAR(times["moving"], 45, 1);
  EXPECT_NEAR(times["tracks"], 15, 4);
  EXPECT_NEAR(times["paths"], 3, 1);
  EXPECT_NEAR(times["cloud"], 3, 1);
  EXPECT_NEAR(times["state"], 12, 3);
}

TEST_F(WatchTest, WithoutFrameSetsItTellsWhoComesAndGoes) {
  steps(40, kAllParts);
  run_.stop(CameraId(1));
  now_ns_ += 2'000'000'000;
  const Snapshot s = watch_.in_between(run_.server(), kAllParts, now_ns_, [&] { return facts_of(run_.map()); });
  ASSERT_EQ(s.events.size(), 1U);
  EXPECT_EQ(s.events[0].kind, "left");
  ASSERT_TRUE(s.state);
  EXPECT_FALSE(s.state->agents.at(1).alive);
  EXPECT_FALSE(s.poses);
}

TEST_F(WatchTest, TheLastWordIsWhole) {
  steps(60, {});
  run_.server().finish();
  const Snapshot s = watch_.at_the_end(run_.server(), kAllParts, now_ns_, [&] { return facts_of(run_.map()); });
  ASSERT_TRUE(s.state && s.cloud && s.paths);
  const auto resting = std::ranges::count_if(run_.map().points(), [](const auto& p) { return p.second.rests(); });
  EXPECT_EQ(static_cast<long>(s.cloud->points.size()), resting);
}

TEST(CloudCopy, TakesSomePointsAtATime) {
  const test::SimWorld world({.points = 350});
  test::SimRun run(world, {});
  for (const auto& path : test::paths_side_by_side(2)) run.add_agent(path);
  run.step(60);
  CloudCopy copy;
  EXPECT_FALSE(copy.under_way());
  copy.begin(run.map());
  std::shared_ptr<PublicCloud> cloud;
  int parts = 0;
  while (!cloud && parts < 1000) {
    EXPECT_TRUE(copy.under_way());
    cloud = copy.go_on(run.map(), 10);
    ++parts;
  }
  ASSERT_TRUE(cloud);
  EXPECT_EQ(cloud->points.size(), run.map().points().size());
  EXPECT_NEAR(parts, static_cast<double>(run.map().points().size()) / 10, 1.1);
  EXPECT_FALSE(copy.under_way());
}

TEST(Snapshot, ANewerOneReplacesParts) {
  Snapshot s;
  s.poses = std::make_shared<const PublicPoses>(PublicPoses{{.t_ns = 1}, {}});
  s.events.push_back({.kind = "joined"});
  Snapshot newer;
  newer.moving = std::make_shared<const PublicMoving>();
  newer.events.push_back({.kind = "left"});
  s.update(std::move(newer));
  EXPECT_TRUE(s.poses && s.moving);
  EXPECT_EQ(s.events.size(), 2U);
  newer = {};
  newer.poses = std::make_shared<const PublicPoses>(PublicPoses{{.t_ns = 2}, {}});
  s.update(std::move(newer));
  EXPECT_EQ(s.poses->t_ns, 2);
}

}  // namespace
}  // namespace coslam::watch_test
