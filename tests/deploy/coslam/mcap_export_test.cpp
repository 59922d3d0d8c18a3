// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "common/dataset/event_file.h"
#include "common/dataset/trajectory.h"
#include "common/mcap/reader.h"
#include "common/ros/cdr.h"
#include "common/ros/convert.h"
#include "common/ros/messages.h"
#include "deploy/coslam/export/export.h"
#include "deploy/coslam/export/result_events.h"
#include "tests/support/temp_folder.h"

namespace coslam::exporting::mcap_export_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr TimeNs kFrame_ns = 100'000'000;

// Three seconds of two cameras, one of them in another map; three points, of which one is seen from 1 s on, one moves
// from 1 to 2 s.
class McapExport : public ::testing::Test {
 protected:
  McapExport() {
    Trajectory a, b;
    for (int i = 0; i <= 30; ++i) {
      a.push_back({i * kFrame_ns, Rigid3(Eigen::Quaterniond::Identity(), {0.1 * i, 0, 0}).inverse()});
      b.push_back({i * kFrame_ns, Rigid3(Eigen::Quaterniond::Identity(), {0, 0.1 * i, 0}).inverse()});
    }
    save_tum(result_.trajectory("a"), a);
    save_tum(result_.of_map(MapId(2)).trajectory("b"), b);
    write_points();
    DynamicWriter moving(result_.dynamic());
    ObjectWriter objects(result_.objects());
    for (int i = 10; i <= 20; ++i) {
      moving.write({i * kFrame_ns, PointId(3), {1, 1, 0.1 * i}, 1e-4 * Eigen::Matrix3d::Identity(), 2});
      objects.write({i * kFrame_ns, ObjectId(7), {1, 1, 0.1 * i}, {0, 0, 1}, {0.5, 1.7, 0.4}, {PointId(3)}});
    }
    moving.close();
    objects.close();
    TrackWriter tracks(result_.tracks("a"));
    tracks.write({FrameId(0), 0, TrackId(4), {100, 50}, PointId(1), PointState::kStatic});
    tracks.close();
    GroupWriter groups(result_.groups());
    groups.write({0, GroupId(1), {"a"}});
    groups.write({0, GroupId(2), {"b"}});
    groups.write({1'500'000'000, GroupId(1), {"a", "b"}});
    groups.write({2'500'000'000, GroupId(1), {"a"}});
    groups.write({2'500'000'000, GroupId(2), {"b"}});
    groups.close();
  }

  void write_points() {
    PointWriter points(result_.points());
    ResultPoint p;
    p.covariance = 4e-4 * Eigen::Matrix3d::Identity();
    for (const std::uint32_t id : {1U, 2U, 3U}) {
      p.id = PointId(id);
      p.position.x() = id;
      p.first_ns = id == 2 ? 1'000'000'000 : 0;
      p.state = id == 3 ? PointState::kDynamic : PointState::kStatic;
      points.write(p);
    }
    points.close();
  }

  mcap::Reader exported() {
    const Files files = export_mcap(contents_of(result_), temp_ / "out");
    EXPECT_THAT(files, ElementsAre(temp_ / "out" / "run.mcap"));
    return mcap::Reader(files.at(0));
  }

  test::TempFolder temp_;
  ResultFolder result_{temp_ / "result"};
};

template <class Message>
std::vector<std::pair<TimeNs, Message>> messages_of(mcap::Reader& reader, const std::string& topic) {
  std::vector<std::pair<TimeNs, Message>> messages;
  const mcap::Channel* channel = reader.find(topic);
  if (channel == nullptr) return messages;
  EXPECT_EQ(reader.schema_of(*channel).encoding, "ros2msg");
  reader.seek({channel->id});
  while (const auto message = reader.next()) {
    const auto* octets = reinterpret_cast<const std::uint8_t*>(message->octets.data());
    const auto read = ros::from_cdr<Message>(std::span(octets, message->octets.size()));
    EXPECT_TRUE(read) << topic;
    if (read) messages.emplace_back(message->noted_ns, *read);
  }
  return messages;
}

TEST_F(McapExport, PosesAreInTheFramesOfTheirMaps) {
  mcap::Reader reader = exported();
  const auto a = messages_of<ros::PoseWithCovarianceStamped>(reader, "/coslam/a/pose");
  const auto b = messages_of<ros::PoseWithCovarianceStamped>(reader, "/coslam/b/pose");
  ASSERT_EQ(a.size(), 31U);
  ASSERT_EQ(b.size(), 31U);
  EXPECT_EQ(a[10].first, 10 * kFrame_ns);
  EXPECT_EQ(a[10].second.header.frame_id, "map");
  EXPECT_NEAR(a[10].second.pose.pose.position.x, 1.0, 1e-9);
  EXPECT_EQ(b[10].second.header.frame_id, "map_2");
  EXPECT_NEAR(b[10].second.pose.pose.position.y, 1.0, 1e-9);
  EXPECT_EQ(messages_of<ros::TFMessage>(reader, "/tf").at(5).second.transforms.size(), 6U);
  const auto odom = messages_of<ros::Odometry>(reader, "/coslam/b/odom");
  EXPECT_EQ(odom.at(10).second.header.frame_id, "b/odom");
  EXPECT_EQ(odom[0].second.pose.pose.position.x, 0);
  const auto length = [](const ros::Point& p) { return std::hypot(p.x, p.y, p.z); };
  EXPECT_NEAR(length(odom[10].second.pose.pose.position), 1.0, 1e-9) << "from where it began";
  const auto paths = messages_of<ros::Path>(reader, "/coslam/a/path");
  EXPECT_EQ(paths.back().second.poses.size(), 31U);
}

TEST_F(McapExport, PointsAppearWhenTheyWereFirstSeen) {
  mcap::Reader reader = exported();
  const auto clouds = messages_of<ros::PointCloud2>(reader, "/coslam/map/points");
  ASSERT_EQ(clouds.size(), 2U) << "one for each change";
  EXPECT_EQ(clouds[0].second.width, 1U);
  EXPECT_EQ(clouds[1].first, 1'000'000'000);
  EXPECT_EQ(clouds[1].second.width, 2U);
}

TEST_F(McapExport, WhatMovesIsGoneWhenItIsOver) {
  mcap::Reader reader = exported();
  const auto moving = messages_of<ros::PointCloud2>(reader, "/coslam/map/moving");
  ASSERT_EQ(moving.size(), 12U);
  EXPECT_EQ(moving.front().first, 10 * kFrame_ns);
  EXPECT_EQ(moving.front().second.width, 1U);
  EXPECT_EQ(moving.back().first, 21 * kFrame_ns);
  EXPECT_EQ(moving.back().second.width, 0U) << "one that is empty";
  const auto boxes = messages_of<ros::MarkerArray>(reader, "/coslam/objects");
  EXPECT_EQ(boxes.front().second.markers.at(0).id, 7);
}

TEST_F(McapExport, GroupsThatMeetAndPartAreEvents) {
  std::vector<std::string> told;
  for (const PublicEvent& e : public_events(result_)) told.push_back(e.kind + " " + e.text);
  EXPECT_THAT(told, ElementsAre("merge a and b share a view now", "split a and b share no view any more"));
  mcap::Reader reader = exported();
  reader.seek({reader.find("/coslam/events")->id});
  EXPECT_THAT(reader.next()->octets, HasSubstr("\"kind\":\"merge\""));
}

TEST_F(McapExport, TheStateSaysWhoIsWhere) {
  mcap::Reader reader = exported();
  reader.seek({reader.find("/coslam/state")->id}, 2'000'000'000);
  const auto state = nlohmann::json::parse(reader.next()->octets);
  EXPECT_EQ(state["agents"].size(), 2U);
  EXPECT_EQ(state["agents"][0]["name"], "a");
  EXPECT_EQ(state["agents"][0]["state"], "tracking");
  EXPECT_EQ(state["agents"][1]["frame"], "map_2");
  EXPECT_EQ(state["groups"].size(), 1U);
  EXPECT_EQ(state["run"], "");
  EXPECT_TRUE(state["server"]["key_frames"].is_null()) << "a result does not hold it";
  EXPECT_TRUE(state["agents"][0]["lag_s"].is_null());
  reader.seek({reader.find("/coslam/a/tracks")->id});
  EXPECT_THAT(reader.next()->octets, HasSubstr("[4,100.0,50.0,1]"));
}

// Of a: lost from 1 to 1.5 s, without images from 2 to 2.5 s, and from 2.7 s on.
TEST_F(McapExport, WhoIsLostIsNotWhoSentNothing) {
  Trajectory a, b;
  for (int i = 0; i <= 30; ++i) {
    b.push_back({i * kFrame_ns, Rigid3()});
    if (i < 10 || (i >= 15 && i < 20) || (i >= 25 && i < 27)) a.push_back({i * kFrame_ns, Rigid3()});
  }
  const ResultFolder result(temp_ / "gaps");
  save_tum(result.trajectory("a"), a);
  save_tum(result.trajectory("b"), b);
  PointWriter(result.points()).close();
  EventWriter events(result.events());
  events.write({.t_ns = 10 * kFrame_ns, .kind = "camera_lost", .why = "no_pose", .camera = "a", .a = 12, .b = 3});
  events.write({.t_ns = 15 * kFrame_ns, .kind = "camera_found", .why = "no_pose", .camera = "a"});
  events.close();
  const Files files = export_mcap(contents_of(result), temp_ / "out");
  mcap::Reader reader(files.at(0));
  const auto agent_at = [&](TimeNs t_ns) {
    reader.seek({reader.find("/coslam/state")->id}, t_ns);
    return nlohmann::json::parse(reader.next()->octets)["agents"][0];
  };
  EXPECT_EQ(agent_at(500'000'000)["state"], "tracking");
  EXPECT_EQ(agent_at(1'150'000'000)["state"], "lost");
  EXPECT_THAT(std::string(agent_at(1'150'000'000)["why"]), HasSubstr("12"));
  EXPECT_EQ(agent_at(1'600'000'000)["state"], "tracking");
  EXPECT_EQ(agent_at(2'300'000'000)["state"], "unheard");
  EXPECT_EQ(agent_at(2'950'000'000)["alive"], false);
}

}  // namespace
}  // namespace coslam::exporting::mcap_export_test
