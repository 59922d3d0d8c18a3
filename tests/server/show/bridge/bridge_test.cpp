// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Between two DDS domains over the real middleware, through the loopback device.
#include "server/show/bridge/bridge.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "common/base/error.h"
#include "common/ros/cdr.h"
#include "common/ros/convert.h"
#include "common/ros/messages.h"
#include "common/wire/codec.h"
#include "common/wire/ros_domain.h"
#include "server/show/bridge/ros_topics.h"
#include "tests/support/eventually.h"
#include "tests/support/test_domain.h"
#include "tests/support/wire_values.h"

namespace coslam::bridge_test {
namespace {

using namespace std::chrono_literals;
using Octets = std::vector<std::uint8_t>;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class BridgeTest : public testing::Test {
 protected:
  BridgeOptions options(const std::string& px4_agent = "") const {
    BridgeOptions o;
    o.wire = loopback_config(fleet_.number());
    o.bridge.domain = nodes_.number();
    o.bridge.px4.agent = px4_agent;
    return o;
  }
  WireConfig nodes() const { return ros_wire(nodes_.number()); }

  const test::TestDomain fleet_, nodes_;
  Participant server_{loopback_config(fleet_.number()), "coslam-server"};
  Writer<idl::PublicSample> public_{server_};
};

// A node that reads one topic.
class Node {
 public:
  Node(const WireConfig& config, const OctetTopic& topic)
      : participant_(config, "node"), reader_(participant_, topic, [this](std::span<const std::uint8_t> octets) {
          heard_.add(Octets(octets.begin(), octets.end()));
        }) {}
  test::Collector<Octets>& heard() { return heard_; }

 private:
  test::Collector<Octets> heard_;
  Participant participant_;
  OctetReader reader_;
};

// Calls act() until done() or the deadline; both ends have to find each other first.
template <class Act, class Done>
bool until(Act act, Done done) {
  const auto deadline = std::chrono::steady_clock::now() + test::kDeadline;
  while (std::chrono::steady_clock::now() < deadline) {
    act();
    if (done()) return true;
    std::this_thread::sleep_for(20ms);  // a pace, nothing waits for it
  }
  return false;
}

TEST_F(BridgeTest, NodesHearWhatTheServerSays) {
  const Bridge bridge(options());
  const PublicSample said{"/coslam/cam0/odom", "nav_msgs/msg/Odometry", 5, ros::to_cdr(ros::Odometry())};
  Node node(nodes(), *ros_topic(said.topic, said.type));
  ASSERT_TRUE(until([&] { public_.write(encode(said)); }, [&] { return !node.heard().values().empty(); }));
  EXPECT_EQ(node.heard().values().front(), said.octets);
}

TEST_F(BridgeTest, ALargeMapReachesANodeThatComesLater) {
  const Bridge bridge(options());
  PublicSample said{"/coslam/map/points", "sensor_msgs/msg/PointCloud2", 5, {}};
  ros::PointCloud2 cloud;
  cloud.data.assign(2'000'000, 7);
  said.octets = ros::to_cdr(cloud);
  const auto message = encode(said);
  Participant participant(nodes(), "node");
  const OctetTopic topic = *ros_topic(said.topic, said.type);
  {
    test::Collector<Octets> heard;
    const OctetReader early(participant, topic, [&](std::span<const std::uint8_t> octets) {
      heard.add(Octets(octets.begin(), octets.end()));
    });
    auto next = std::chrono::steady_clock::now();
    const auto say = [&] {  // twice a second
      if (std::chrono::steady_clock::now() < next) return;
      next += 500ms;
      public_.write(message);
    };
    ASSERT_TRUE(until(say, [&] { return !heard.values().empty(); }));
  }
  Node late(nodes(), topic);
  ASSERT_TRUE(late.heard().wait_count(1)) << "the bridge keeps the newest";
  EXPECT_TRUE(late.heard().values().front() == said.octets);
}

TEST_F(BridgeTest, TheMapHasUprightAxes) {
  const Bridge bridge(options());
  Node node(nodes(), *ros_topic("/tf_static", "tf2_msgs/msg/TFMessage"));
  ASSERT_TRUE(node.heard().wait_count(1));
  const auto heard = ros::from_cdr<ros::TFMessage>(node.heard().values().front());
  ASSERT_TRUE(heard);
  EXPECT_EQ(heard->transforms.at(0).header.frame_id, "world");
  EXPECT_EQ(heard->transforms.at(0).child_frame_id, "map");
}

TEST_F(BridgeTest, Px4HearsAnAgentOfKnownScale) {
  const Bridge bridge(options("cam0"));
  Writer<idl::AgentPose> poses(server_);
  Participant agent(loopback_config(fleet_.number()), "agent");
  Writer<idl::TrackFrame> frames(agent);
  Node px4(nodes(), *ros_topic("/fmu/in/vehicle_visual_odometry", "px4_msgs/msg/VehicleOdometry"));
  AgentPose pose = test::WireValues(1).agent_pose("cam0", RunId(5));
  TrackFrame frame = test::WireValues(1).frame("cam0", RunId(5), 1, 0);
  frame.pose_state = PoseState::kTracked;
  frame.server_run = pose.server_run;
  frame.epoch = pose.epoch;
  const auto fly = [&] {
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    frame.capture_ns = std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
    frame.frame = FrameId(frame.frame.value + 1);
    poses.write(encode(pose));
    frames.write(encode(frame, 16.0));
  };
  ASSERT_TRUE(until(fly, [&] { return !px4.heard().values().empty(); }));
  const auto heard = ros::from_cdr<ros::VehicleOdometry>(px4.heard().values().back());
  ASSERT_TRUE(heard);
  EXPECT_EQ(heard->pose_frame, ros::VehicleOdometry::kFrd);
}

TEST_F(BridgeTest, OneDomainForBothIsRefused) {
  BridgeOptions o = options();
  o.bridge.domain = o.wire.domain;
  EXPECT_THAT([&] { Bridge bridge(o); }, ThrowsMessage<UserError>(HasSubstr("is that of the fleet and of ROS 2")));
}

TEST_F(BridgeTest, WhatCanNeverWorkIsRefused) {
  const auto refused = [this](void (*spoil)(BridgeConfig&)) {
    BridgeOptions o = options("left");
    spoil(o.bridge);
    std::string why;
    try {
      const Bridge bridge(o);
    } catch (const UserError& error) {
      why = error.what();
    }
    return why;
  };
  EXPECT_THAT(refused([](BridgeConfig& c) { c.px4.agent = "a b"; }), HasSubstr("bridge.px4.agent: 'a b'"));
  for (const char* topic : {"", "/", "fmu", "/fmu/", "/fmu//in", "/1st", "/a b"}) {
    BridgeOptions o = options();
    o.bridge.px4.topic = topic;
    EXPECT_THAT([&] { const Bridge bridge(o); }, ThrowsMessage<UserError>(HasSubstr("is no topic of ROS"))) << topic;
  }
  EXPECT_THAT(refused([](BridgeConfig& c) { c.map.down_y = 0; }), HasSubstr("no direction"));
}

}  // namespace
}  // namespace coslam::bridge_test
