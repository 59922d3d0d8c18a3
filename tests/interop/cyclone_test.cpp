// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What coslam-bridge publishes, as a node made with another DDS receives it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>

#include "common/ros/cdr.h"
#include "common/ros/convert.h"
#include "common/ros/messages.h"
#include "common/ros/views.h"
#include "common/wire/codec.h"
#include "common/wire/participant.h"
#include "tests/interop/cyclone_here.h"
#include "tests/support/child_process.h"
#include "tests/support/temp_folder.h"
#include "tests/support/test_domain.h"

namespace coslam::cyclone_test {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

std::string text_in(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

// A map server, and an agent of it, that say the same again and again.
class Speaker {
 public:
  explicit Speaker(int domain) : participant_(loopback_config(domain), "coslam-server") {}

  void speak() {
    const ros::Header header = ros::header_of(7'000'000'001, "map");
    ros::Odometry odometry{header, "cam0/base_link", {}, {}};
    odometry.pose.pose.position = {1.5, -2, 3};
    odometry.pose.covariance[35] = 0.25;
    say("/coslam/cam0/odom", "nav_msgs/msg/Odometry", ros::to_cdr(odometry));
    std::vector<ros::StaticPoint> points(5000);
    points[0].position = {0.5F, 1, 2};
    say("/coslam/map/points", "sensor_msgs/msg/PointCloud2", ros::to_cdr(ros::static_cloud(header, points)));
    const std::string state = "{\"t_s\":7}";
    say("/coslam/state", kJsonType, {state.begin(), state.end()});
    fly();
  }

 private:
  void say(const std::string& topic, const std::string& type, std::vector<std::uint8_t> octets) {
    public_.write(encode(PublicSample{topic, type, 7'000'000'001, std::move(octets)}));
  }

  // One metre ahead and two up.
  void fly() {
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    const Rigid3 map_from_cam(Eigen::Quaterniond::Identity(), {0, -2, 1});
    AgentPose pose{"cam0", RunId(1), RunId(2), 0, MapId(1), MapEpoch(1), PoseState::kTracked, true, map_from_cam};
    poses_.write(encode(pose));
    TrackFrame frame;
    frame.agent = pose.agent;
    frame.agent_run = pose.agent_run;
    frame.server_run = pose.server_run;
    frame.epoch = pose.epoch;
    frame.frame = FrameId(++frames_sent_);
    frame.capture_ns = std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
    frame.pose_state = PoseState::kTracked;
    frame.cam_from_world = map_from_cam.inverse();
    frame.pose_inliers = 60;
    frames_.write(encode(frame, 16.0));
  }

  Participant participant_;
  Writer<idl::PublicSample> public_{participant_};
  Writer<idl::AgentPose> poses_{participant_};
  Writer<idl::TrackFrame> frames_{participant_};
  std::uint32_t frames_sent_ = 0;
};

TEST(Cyclone, ANodeHearsTheBridge) {
  const test::TestDomain fleet, nodes;
  const test::TempFolder folder;
  const std::string from = std::to_string(fleet.number()), to = std::to_string(nodes.number());
  test::ChildProcess bridge({COSLAM_BRIDGE, "--loopback", "--from", from, "--domain", to, "--px4", "cam0"});
  test::keep_cyclone_here();
  const std::string heard = (folder / "heard").string();
  test::ChildProcess node({"/bin/sh", "-c", "exec \"$0\" \"$@\" > " + heard, CYCLONE_NODE, to, "odom",
                           "rt/coslam/cam0/odom", "cloud", "rt/coslam/map/points", "text", "rt/coslam/state", "px4",
                           "rt/fmu/in/vehicle_visual_odometry"});
  Speaker speaker(fleet.number());
  std::optional<int> status;
  for (int i = 0; i < 1200 && !status; ++i) {
    speaker.speak();
    status = node.wait_for(50ms);
  }
  const std::string text = text_in(heard);
  ASSERT_TRUE(status) << text;
  EXPECT_EQ(*status, 0) << text;
  EXPECT_THAT(text, HasSubstr("odom 7.000000001 map cam0/base_link 1.5 -2 3 1 0.25\n"));
  EXPECT_THAT(text, HasSubstr("cloud map 5000 8 140000 x 0.5\n"));
  EXPECT_THAT(text, HasSubstr("text {\"t_s\":7}\n"));
  EXPECT_THAT(text, HasSubstr("px4 2 1 0 -2 1 0 60\n")) << "FRD: one metre ahead, two up";
}

}  // namespace
}  // namespace coslam::cyclone_test
