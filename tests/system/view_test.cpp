// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// A run as somebody sees it who looks at it on the web while it happens.
#include <gmock/gmock.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <span>

#include "common/ros/cdr.h"
#include "common/ros/messages.h"
#include "tests/server/show/web/web_client.h"
#include "tests/support/test_domain.h"
#include "tests/system/program.h"
#include "tests/system/small_scene.h"

namespace coslam::view_test {
namespace {

using test::http_get;
using test::Program;
using test::SmallScene;
using test::WebClient;
using ::testing::HasSubstr;

constexpr int kFrames = 900;  // half a minute in real time

// Of the link that it prints; 0: none.
std::uint16_t port_of(Program& run) {
  const std::string link = "view: http://127.0.0.1:";
  if (!run.prints(link) || !run.prints("/\n")) return 0;
  return static_cast<std::uint16_t>(std::stoi(run.out().substr(run.out().find(link) + link.size())));
}

template <class Message>
Message ros_of(const WebClient::Message& message) {
  const auto* octets = reinterpret_cast<const std::uint8_t*>(message.octets.data());
  return ros::from_cdr<Message>(std::span(octets, message.octets.size())).value_or(Message());
}

TEST(View, ARunIsShownWhileItHappens) {
  const SmallScene scene(2, kFrames);
  const test::TestDomain domain;
  Program run("coslam", {"run", scene.sequence(), "--out", (scene.folder() / "result").string(), "--rate", "1",
                         "--domain", std::to_string(domain.number()), "--view=0"});
  const std::uint16_t port = port_of(run);
  ASSERT_NE(port, 0) << run.err();
  EXPECT_EQ(http_get(port, "/healthz").status, 200);
  EXPECT_EQ(http_get(port, "/").status, 200);

  WebClient viewer(port, {.protocol = "foxglove.sdk.v1"});
  for (const char* topic : {"/coslam/map/points", "/coslam/map/moving", "/coslam/cam1/pose", "/coslam/state"})
    ASSERT_TRUE(viewer.subscribe(topic)) << topic;
  const auto cloud =
      viewer.message_where("/coslam/map/points", [](const auto& m) { return ros_of<ros::PointCloud2>(m).width > 30; });
  ASSERT_TRUE(cloud) << run.err();
  EXPECT_TRUE(viewer.message_where("/coslam/map/moving", [](const auto&) { return true; }));
  const auto where = [&] {
    const auto pose = viewer.message_where("/coslam/cam1/pose", [](const auto&) { return true; });
    return pose ? ros_of<ros::PoseWithCovarianceStamped>(*pose).pose.pose.position.x : std::nan("");
  };
  const double before = where();
  EXPECT_TRUE(viewer.message_where("/coslam/map/points", [&](const auto& m) { return m.t_ns > cloud->t_ns; }));
  EXPECT_GT(std::abs(where() - before), 0.01) << "it moves";

  EXPECT_EQ(http_get(port, "/readyz").status, 200);
  const std::string metrics = http_get(port, "/metrics").body;
  EXPECT_THAT(metrics, HasSubstr("coslam_agent_alive{agent=\"cam0\"} 1\n"));
  EXPECT_THAT(metrics, HasSubstr("coslam_view_subscribers 1\n"));
  EXPECT_THAT(http_get(port, "/api/v1/explain?kind=camera&id=cam0").body, HasSubstr("said hello"));
  EXPECT_THAT(http_get(port, "/api/v1/map.ply").body, ::testing::StartsWith("ply\n"));
  EXPECT_EQ(http_get(port, "/../../etc/passwd").status, 400);

  run.signal(SIGINT);
  EXPECT_TRUE(viewer.ended());
  EXPECT_EQ(run.exit_code(), 0) << run.err();
}

TEST(View, ARunInOneProcessToo) {
  const SmallScene scene(2, kFrames);
  Program run("coslam", {"run", scene.sequence(), "--out", (scene.folder() / "result").string(), "--inline", "--set",
                         "server.view.port=0"});
  const std::uint16_t port = port_of(run);
  ASSERT_NE(port, 0) << run.err();
  WebClient viewer(port);
  ASSERT_TRUE(viewer.subscribe("/tf"));
  const auto tf =
      viewer.message_where("/tf", [](const auto& m) { return !ros_of<ros::TFMessage>(m).transforms.empty(); });
  ASSERT_TRUE(tf) << run.err();
  EXPECT_EQ(ros_of<ros::TFMessage>(*tf).transforms[0].child_frame_id, "cam0/odom");
  run.signal(SIGINT);
  EXPECT_EQ(run.exit_code(), 0) << run.err();
}

TEST(View, WhatAServerHeardIsShownOnceMore) {
  const SmallScene scene(2, 300);
  const auto file = [&](const char* name) { return (scene.folder() / name).string(); };
  Program run("coslam", {"run", scene.sequence(), "--out", file("result"), "--inline", "--record", file("a.rec")});
  ASSERT_EQ(run.exit_code(), 0) << run.err();
  Program replay("coslam", {"replay", file("a.rec"), "--out", file("again"), "--rate", "1", "--view=0"});
  const std::uint16_t port = port_of(replay);
  ASSERT_NE(port, 0) << replay.err();
  WebClient viewer(port);
  ASSERT_TRUE(viewer.subscribe("/coslam/map/points"));
  EXPECT_TRUE(
      viewer.message_where("/coslam/map/points", [](const auto& m) { return ros_of<ros::PointCloud2>(m).width > 30; }));
  replay.signal(SIGINT);
  EXPECT_EQ(replay.exit_code(), 0) << replay.err();
  Program wrong("coslam", {"replay", file("a.rec"), "--out", file("none"), "--view=70000"});
  EXPECT_EQ(wrong.exit_code(), 2) << "a wrong port";
  EXPECT_FALSE(std::filesystem::exists(file("none")));
}

TEST(View, AFinishedRunIsShown) {
  const SmallScene scene(2, 30);
  const std::string result = (scene.folder() / "result").string();
  Program run("coslam", {"run", scene.sequence(), "--out", result, "--inline"});
  ASSERT_EQ(run.exit_code(), 0) << run.err();
  Program view("coslam", {"view", result, "--port", "0"});
  const std::string link = "view: http://127.0.0.1:";
  ASSERT_TRUE(view.prints(link) && view.prints("/?recorded=1\n")) << view.err();
  const auto port = static_cast<std::uint16_t>(std::stoi(view.out().substr(view.out().find(link) + link.size())));
  EXPECT_THAT(http_get(port, "/api/v1/run.mcap").body, ::testing::StartsWith("\x89MCAP0\r\n"));
  EXPECT_THAT(http_get(port, "/api/v1/explain?kind=camera&id=cam0").body, HasSubstr("said hello"));
  EXPECT_EQ(http_get(port, "/api/v1/explain?kind=house&id=1").status, 400);
  EXPECT_EQ(http_get(port, "/api/v1/map.ply").status, 404);
  view.signal(SIGINT);
  EXPECT_EQ(view.exit_code(), 0);
}

TEST(View, OnlyWhatIsThereIsShown) {
  Program view("coslam", {"view", "/nowhere/at.all"});
  EXPECT_EQ(view.exit_code(), 1);
  EXPECT_THAT(view.err(), HasSubstr("there is no /nowhere/at.all"));
}

TEST(View, ATakenPortIsNamed) {
  const test::TestDomain domain;
  Program one("coslam-server", {"--loopback", "--domain", std::to_string(domain.number()), "--view", "0"});
  ASSERT_TRUE(one.says("view: http://127.0.0.1:")) << one.err();
  ASSERT_TRUE(one.says("/\n"));
  const std::string& said = one.err();
  const std::string link = "view: http://127.0.0.1:";
  const std::string port = std::to_string(std::stoi(said.substr(said.find(link) + link.size())));
  Program other("coslam-server", {"--loopback", "--domain", std::to_string(domain.number()), "--view", port});
  EXPECT_EQ(other.exit_code(), 1);
  EXPECT_THAT(other.err(), HasSubstr("port " + port));
}

}  // namespace
}  // namespace coslam::view_test
