// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// A run as somebody sees it who looks at it on the web while it happens.
#include <gmock/gmock.h>

#include <cmath>
#include <csignal>
#include <span>

#include "common/ros/cdr.h"
#include "common/ros/messages.h"
#include "tests/server/web/web_client.h"
#include "tests/support/test_domain.h"
#include "tests/system/program.h"
#include "tests/system/small_scene.h"

namespace coslam {
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
  for (const char* topic : {"/coslam/map/points", "/coslam/map/moving", "/coslam/cam1/odom", "/coslam/state"})
    ASSERT_TRUE(viewer.subscribe(topic)) << topic;
  const auto cloud =
      viewer.message_where("/coslam/map/points", [](const auto& m) { return ros_of<ros::PointCloud2>(m).width > 30; });
  ASSERT_TRUE(cloud) << run.err();
  EXPECT_TRUE(viewer.message_where("/coslam/map/moving", [](const auto&) { return true; }));
  const auto where = [&] {
    const auto odom = viewer.message_where("/coslam/cam1/odom", [](const auto&) { return true; });
    return odom ? ros_of<ros::Odometry>(*odom).pose.pose.position.x : std::nan("");
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
  EXPECT_EQ(ros_of<ros::TFMessage>(*tf).transforms[0].child_frame_id, "cam0/camera_optical_frame");
  run.signal(SIGINT);
  EXPECT_EQ(run.exit_code(), 0) << run.err();
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
}  // namespace coslam
