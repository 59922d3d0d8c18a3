// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/export/result_snapshots.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "common/dataset/event_file.h"
#include "tests/support/temp_folder.h"

namespace coslam::exporting::result_snapshots_test {
namespace {

constexpr TimeNs kFrame_ns = 100'000'000;

// A result of one camera at ten images a second.
class Snapshots : public ::testing::Test {
 protected:
  Snapshots() { write_path("a", 0, 31); }

  void write_path(const std::string& agent, int from, int to) const {
    Trajectory path;
    for (int i = from; i < to; ++i)
      path.push_back({i * kFrame_ns, Rigid3(Eigen::Quaterniond::Identity(), {0.1 * i, 0, 0}).inverse()});
    save_tum(result_.trajectory(agent), path);
  }
  void write_points(const std::vector<TimeNs>& first_seen_ns) const {
    PointWriter points(result_.points());
    ResultPoint p;
    for (const TimeNs t_ns : first_seen_ns) {
      p.id.value += 1;
      p.first_ns = t_ns;
      points.write(p);
    }
    points.close();
  }
  std::vector<Snapshot> all() const {
    ResultSnapshots snapshots(contents_of(result_));
    std::vector<Snapshot> out;
    while (auto snapshot = snapshots.next()) out.push_back(std::move(*snapshot));
    EXPECT_FALSE(snapshots.next()) << "the end stays the end";
    return out;
  }
  // Instants at which a part was told.
  template <class PartOf>
  static std::vector<TimeNs> told_at(const std::vector<Snapshot>& snapshots, PartOf part_of) {
    std::vector<TimeNs> out;
    for (const Snapshot& s : snapshots) {
      if (const auto& part = part_of(s)) out.push_back(part->t_ns);
    }
    return out;
  }

  test::TempFolder temp_;
  ResultFolder result_{temp_ / "result"};
};

TEST_F(Snapshots, EachPartHasItsPaceAndTheLastWordIsWhole) {
  write_points({0});
  const auto snapshots = all();
  ASSERT_EQ(snapshots.size(), 31U);
  for (const Snapshot& s : snapshots) ASSERT_TRUE(s.poses);
  const auto states = told_at(snapshots, [](const Snapshot& s) { return s.state; });
  for (std::size_t i = 1; i + 1 < states.size(); ++i) EXPECT_GE(states[i] - states[i - 1], 250'000'000) << i;
  EXPECT_EQ(states.back(), 30 * kFrame_ns);
  const auto paths = told_at(snapshots, [](const Snapshot& s) { return s.paths; });
  EXPECT_EQ(paths, (std::vector<TimeNs>{0, 10 * kFrame_ns, 20 * kFrame_ns, 30 * kFrame_ns}));
  EXPECT_EQ(snapshots.back().paths->cameras.at(0).cam_from_map.size(), 31U);
}

TEST_F(Snapshots, ACloudIsToldWhenItHasChangedAndNotTooOften) {
  write_points({0, 1 * kFrame_ns, 2 * kFrame_ns, 15 * kFrame_ns});
  const auto snapshots = all();
  const auto clouds = told_at(snapshots, [](const Snapshot& s) { return s.cloud; });
  EXPECT_EQ(clouds, (std::vector<TimeNs>{0, 10 * kFrame_ns, 20 * kFrame_ns}));
  EXPECT_EQ(snapshots[0].cloud->points.size(), 1U);
  EXPECT_EQ(snapshots[10].cloud->points.size(), 3U);
  EXPECT_EQ(snapshots[20].cloud->points.size(), 4U);
  EXPECT_EQ(snapshots.back().state->points, 4U);
}

TEST_F(Snapshots, WithoutPointsAnEmptyCloudIsToldOnce) {
  const auto clouds = told_at(all(), [](const Snapshot& s) { return s.cloud; });
  EXPECT_EQ(clouds, std::vector<TimeNs>{0});
}

TEST_F(Snapshots, ALongPathIsThinnedToTheSamePosesEachTime) {
  write_path("a", 0, 1200);
  std::optional<PublicPaths> before;
  std::size_t longest = 0;
  for (const Snapshot& s : all()) {
    if (!s.paths) continue;
    const auto& poses = s.paths->cameras.at(0).cam_from_map;
    longest = std::max(longest, poses.size());
    if (before && before->cameras.at(0).cam_from_map.size() <= poses.size()) {
      const auto& fewer = before->cameras.at(0).cam_from_map;
      for (std::size_t i = 0; i < fewer.size(); ++i) ASSERT_EQ(fewer[i].first, poses[i].first) << i;
    }
    before = *s.paths;
  }
  EXPECT_LE(longest, 502U);
  ASSERT_TRUE(before);
  EXPECT_GT(before->cameras.at(0).cam_from_map.size(), 250U);
  EXPECT_EQ(before->cameras.at(0).cam_from_map[1].first % (2 * kFrame_ns), 0);
}

TEST_F(Snapshots, TracksComeWithTheirInstantAndCountInTheState) {
  TrackWriter tracks(result_.tracks("a"));
  for (std::uint32_t id = 1; id <= 5; ++id) {
    const bool bound = id <= 3;
    tracks.write({FrameId(0),
                  0,
                  TrackId(id),
                  {10, 10},
                  bound ? PointId(id) : PointId(),
                  bound ? std::optional(PointState::kStatic) : std::nullopt});
  }
  tracks.write({FrameId(10), 10 * kFrame_ns, TrackId(9), {10, 10}, PointId(), std::nullopt});
  tracks.close();
  const auto snapshots = all();
  ASSERT_TRUE(snapshots[0].tracks);
  EXPECT_EQ(snapshots[0].tracks->cameras.at(0).tracks.size(), 5U);
  EXPECT_EQ(snapshots[0].state->agents.at(0).tracks, 5U);
  EXPECT_EQ(snapshots[0].state->agents.at(0).bound, 3U);
  EXPECT_FALSE(snapshots[5].tracks);
  EXPECT_TRUE(snapshots[10].tracks);
  EXPECT_EQ(snapshots.back().state->agents.at(0).tracks, 1U);
}

TEST_F(Snapshots, WhatMovesIsCountedAndThenToldToBeAtRestOnce) {
  DynamicWriter moving(result_.dynamic());
  ObjectWriter objects(result_.objects());
  for (const std::uint32_t id : {3U, 4U}) moving.write({0, PointId(id), {1, 1, 1}, Eigen::Matrix3d::Identity(), 2});
  objects.write({0, ObjectId(7), {1, 1, 1}, {0, 0, 1}, {1, 1, 1}, {PointId(3)}});
  moving.close();
  objects.close();
  const auto snapshots = all();
  EXPECT_EQ(snapshots[0].state->moving_points, 2U);
  EXPECT_EQ(snapshots[0].state->objects, 1U);
  const auto told = told_at(snapshots, [](const Snapshot& s) { return s.moving; });
  EXPECT_EQ(told, (std::vector<TimeNs>{0, kFrame_ns}));
  EXPECT_TRUE(snapshots[1].moving->maps.empty());
  EXPECT_EQ(snapshots.back().state->moving_points, 0U);
}

TEST_F(Snapshots, AnAgentIsInNoMapBeforeItsFirstPoseAndGoneAfterItsLast) {
  write_path("b", 10, 15);
  const auto snapshots = all();
  const PublicAgent& before = snapshots[0].state->agents.at(1);
  EXPECT_EQ(before.standing, PublicStanding::kNone);
  EXPECT_EQ(before.why, "it has no place in any map yet");
  EXPECT_TRUE(before.alive);
  const PublicAgent& after = snapshots.back().state->agents.at(1);
  EXPECT_FALSE(after.alive);
  EXPECT_EQ(after.why, "its images have ended");
  EXPECT_EQ(after.frames_used, 5U);
  EXPECT_FALSE(after.cam_from_map);
  EXPECT_EQ(snapshots.back().state->agents.at(0).standing, PublicStanding::kTracking);
  EXPECT_TRUE(snapshots.back().state->agents.at(0).cam_from_map);
}

TEST_F(Snapshots, AScaleIsKnownInTheMainMapAlone) {
  const ResultFolder apart = result_.of_map(MapId(4));
  save_tum(apart.trajectory("b"), {{0, Rigid3()}, {30 * kFrame_ns, Rigid3()}});
  write_json(result_.report(),
             {{"server", {{"scale_known", true}}},
              {"agents", {{"a", nlohmann::json::object()}, {"b", nlohmann::json::object()}}},
              {"maps", {{{"map", 1}, {"agents", {{"a", 31}}}}, {{"map", 4}, {"agents", {{"b", 2}}}}}}});
  const auto snapshots = all();
  const PublicState& state = *snapshots.back().state;
  EXPECT_TRUE(state.scale_known);
  EXPECT_TRUE(state.agents.at(0).scale_known);
  EXPECT_FALSE(state.agents.at(1).scale_known);
  EXPECT_EQ(state.agents.at(1).map, MapId(4));
  EXPECT_EQ(state.maps, 2U);
}

TEST_F(Snapshots, GroupsAreThoseOfTheNewestInstant) {
  write_path("b", 0, 31);
  GroupWriter groups(result_.groups());
  groups.write({0, GroupId(1), {"a"}});
  groups.write({0, GroupId(2), {"b"}});
  groups.write({20 * kFrame_ns, GroupId(1), {"a", "b"}});
  groups.close();
  const auto snapshots = all();
  EXPECT_EQ(snapshots[0].state->groups.size(), 2U);
  EXPECT_EQ(snapshots[0].state->agents.at(1).group, 1);
  EXPECT_EQ(snapshots.back().state->groups.size(), 1U);
  EXPECT_EQ(snapshots.back().state->agents.at(1).group, 0);
}

TEST_F(Snapshots, EventsComeAtTheirTimeAndNoneIsLeftAtTheEnd) {
  EventWriter events(result_.events());
  events.write({.t_ns = 10 * kFrame_ns, .kind = "camera_lost", .why = "no_pose", .camera = "a", .a = 12, .b = 3});
  events.write({.t_ns = 99 * kFrame_ns, .kind = "camera_found", .why = "no_pose", .camera = "a"});
  events.close();
  const auto snapshots = all();
  EXPECT_EQ(snapshots[10].events.size(), 1U);
  EXPECT_EQ(snapshots[10].events.at(0).kind, "lost");
  EXPECT_EQ(snapshots.back().events.size(), 1U) << "it is later than any pose";
  std::size_t told = 0;
  for (const Snapshot& s : snapshots) told += s.events.size();
  EXPECT_EQ(told, 2U);
}

TEST_F(Snapshots, AResultWithoutPosesHasNone) {
  save_tum(result_.trajectory("a"), {});
  EXPECT_TRUE(all().empty());
}

}  // namespace
}  // namespace coslam::exporting::result_snapshots_test
