// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The bridge beside a server and agents at work: nodes hear of the map, and nobody depends on the bridge.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <optional>

#include "common/dataset/result.h"
#include "common/dataset/trajectory.h"
#include "common/mcap/reader.h"
#include "common/ros/cdr.h"
#include "common/ros/messages.h"
#include "common/ros/type.h"
#include "common/wire/octet_topic.h"
#include "common/wire/ros_domain.h"
#include "server/show/bridge/bridge.h"
#include "server/show/bridge/ros_topics.h"
#include "tests/support/eventually.h"
#include "tests/support/test_domain.h"
#include "tests/system/program.h"
#include "tests/system/small_scene.h"

namespace coslam::bridge_test {
namespace {

using test::Program;
using test::SmallScene;

constexpr int kFrames = 500;  // in lock-step: some ten seconds

class BridgeRun : public ::testing::Test {
 protected:
  std::vector<std::string> server() const {
    return {"--loopback", "--domain", fleet(), "--out", runs_.string(), "--mcap", mcap_.string()};
  }
  std::vector<std::string> bridge() const { return {"--loopback", "--from", fleet(), "--domain", nodes()}; }
  std::vector<std::string> agent(int camera) const { return scene_.agent(camera, fleet()); }
  std::string fleet() const { return std::to_string(fleet_.number()); }
  std::string nodes() const { return std::to_string(nodes_.number()); }

  const SmallScene scene_{2, kFrames};
  const std::filesystem::path runs_ = scene_.folder() / "runs";
  const std::filesystem::path mcap_ = scene_.folder() / "run.mcap";
  const test::TestDomain fleet_, nodes_;
};

// What a node hears of one topic.
template <class Message>
class Heard {
 public:
  Heard(Participant& node, const std::string& topic)
      : reader_(node, *ros_topic(topic, ros::type_text<Message>().name), [this](std::span<const std::uint8_t> octets) {
          if (auto message = ros::from_cdr<Message>(octets)) messages_.add(std::move(*message));
        }) {}
  bool more_than(std::size_t before) { return messages_.wait_count(before + 1); }
  template <class Condition>
  bool one_that(Condition condition) {
    return messages_.wait([&](const auto& messages) { return std::ranges::any_of(messages, condition); });
  }
  std::vector<Message> all() const { return messages_.values(); }

 private:
  test::Collector<Message> messages_;
  OctetReader reader_;
};

TEST_F(BridgeRun, ABridgeThatDiesLeavesTheMapAsItIs) {
  Participant node(ros_wire(nodes_.number()), "node");
  Heard<ros::Odometry> odometry(node, "/coslam/cam0/odom");
  Heard<ros::PoseWithCovarianceStamped> poses(node, "/coslam/cam0/pose");
  Heard<ros::PointCloud2> points(node, "/coslam/map/points");
  Heard<ros::TFMessage> transforms(node, "/tf");
  Program server("coslam-server", this->server());
  std::optional<Program> bridge;
  bridge.emplace("coslam-bridge", this->bridge());
  Program a("coslam-agent", agent(0)), b("coslam-agent", agent(1));
  ASSERT_TRUE(odometry.more_than(0)) << bridge->err() << server.err();
  EXPECT_TRUE(points.one_that([](const ros::PointCloud2& cloud) { return cloud.width > 10; }));
  ASSERT_TRUE(transforms.more_than(0));
  EXPECT_TRUE(odometry.one_that(
      [](const ros::Odometry& o) { return o.header.frame_id == "cam0/odom" && o.child_frame_id == "cam0/base_link"; }));
  // At first each of the two may have a map of its own.
  EXPECT_TRUE(poses.one_that([](const ros::PoseWithCovarianceStamped& p) { return p.header.frame_id == "map"; }));

  bridge->signal(SIGKILL);
  EXPECT_EQ(bridge->exit_code(), 128 + SIGKILL);
  const std::size_t before = odometry.all().size();
  bridge.emplace("coslam-bridge", this->bridge());
  EXPECT_TRUE(odometry.more_than(before)) << "another one takes its place";

  EXPECT_EQ(a.exit_code(), 0) << a.err();
  EXPECT_EQ(b.exit_code(), 0) << b.err();
  ASSERT_TRUE(server.says("agent cam0 has ended")) << server.err();
  ASSERT_TRUE(server.says("agent cam1 has ended")) << server.err();
  server.signal(SIGINT);
  EXPECT_EQ(server.exit_code(), 0) << server.err();
  mcap::Reader written(mcap_);
  EXPECT_TRUE(written.has_summary()) << "written to its end";
  ASSERT_NE(written.find("/coslam/cam0/odom"), nullptr);
  written.seek({written.find("/coslam/cam0/odom")->id});
  EXPECT_TRUE(written.next());
  for (const char* name : {"cam0", "cam1"}) {
    EXPECT_GT(load_tum(find_result(runs_).trajectory(name)).size(), kFrames * 9U / 10) << name;
  }
}

}  // namespace
}  // namespace coslam::bridge_test
