// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/publish/publisher.h"

#include <gmock/gmock.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "common/ros/cdr.h"
#include "common/ros/convert.h"
#include "common/ros/messages.h"
#include "common/ros/type.h"

namespace coslam::publisher_test {
namespace {

using nlohmann::json;
using ::testing::Contains;
using ::testing::ElementsAre;

const MapId kMain(1), kOther(5);

// One camera a step to the right of the origin that looks along x of the map.
Rigid3 camera_pose() {
  const Eigen::Quaterniond map_from_cam(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitY()));
  return Rigid3(map_from_cam, Eigen::Vector3d(1, 2, 3)).inverse();
}

Rigid3 cam_from_odom() {
  return Rigid3(Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ())), {0.5, 0.25, 0}).inverse() *
         camera_pose();
}

Rigid3 rigid_of(const ros::Transform& t) {
  return {Eigen::Quaterniond(t.rotation.w, t.rotation.x, t.rotation.y, t.rotation.z),
          {t.translation.x, t.translation.y, t.translation.z}};
}

Snapshot snapshot() {
  Snapshot out;
  PublicPoses poses{{2'500'000'000, kMain}, {}};
  PublicPose pose{.agent = "cam-0", .map = kMain, .capture_ns = 2'400'000'000, .cam_from_map = camera_pose()};
  pose.cam_from_odom = cam_from_odom();
  pose.covariance = PoseCovariance::Identity() * 0.01F;
  pose.velocity = PublicVelocity{{0, 0, 1}, {0, 0.5, 0}, 0.1};
  poses.cameras = {pose, {.agent = "far", .map = kOther, .capture_ns = 2'500'000'000}};
  out.poses = std::make_shared<const PublicPoses>(poses);

  PublicMoving moving{{2'500'000'000, kMain}, {}};
  moving.maps[kMain].points.push_back({{1, 2, 3}, 0.1F, PointId(7), ObjectId(2)});
  moving.maps[kMain].objects.push_back({ObjectId(2), {1, 2, 3}, {0.5, 0, 0}, {0.4, 1.7, 0.3}});
  moving.maps[kOther].objects.push_back({ObjectId(9), {4, 5, 6}, {0, 0, 0}, {1, 1, 1}});
  out.moving = std::make_shared<const PublicMoving>(moving);

  PublicCloud cloud{{2'000'000'000, kMain}, {}};
  cloud.points = {{{1, 2, 3}, 0.02F, PointId(11), kMain, false, 12}, {{4, 5, 6}, 0.5F, PointId(12), kOther, true, 2}};
  out.cloud = std::make_shared<const PublicCloud>(cloud);

  PublicPaths paths{{2'500'000'000, kMain},
                    {{"cam-0", kMain, {{0, {}}, {1'000'000'000, camera_pose()}}, {camera_pose()}}}};
  out.paths = std::make_shared<const PublicPaths>(paths);

  PublicTracks tracks{{2'500'000'000, kMain}, {}};
  CameraModel camera{640, 480, 500, 500, 320, 240, DistortionModel::kNone, {}};
  tracks.cameras.push_back({"cam-0",
                            2'400'000'000,
                            camera,
                            {{TrackId(3), {10.25F, 20.5F}, PublicTrackState::kStatic},
                             {TrackId(4), {600, 400}, PublicTrackState::kDynamic}}});
  out.tracks = std::make_shared<const PublicTracks>(tracks);

  PublicState state;
  state.t_ns = 2'500'000'000;
  state.main = kMain;
  state.run = RunId(0xc0ffee);
  for (const char* name : {"cam-0", "far"}) {
    PublicAgent agent;
    agent.facts.name = name;
    agent.alive = true;
    state.agents.push_back(agent);
  }
  state.agents[0].map = kMain;
  state.agents[0].group = 0;
  state.agents[0].standing = PublicStanding::kTracking;
  state.agents[0].cam_from_map = camera_pose();
  state.agents[0].camera = camera;
  state.agents[1].map = kOther;
  state.agents[1].standing = PublicStanding::kLost;
  state.agents[1].why = "no pose";
  state.groups = {{"cam-0"}, {"far"}};
  state.links = {{"cam-0", "far", 12}};
  state.points = 2;
  out.state = std::make_shared<const PublicState>(state);
  out.events.push_back({2'000'000'000, "lost", "far is lost", {"far"}});
  return out;
}

class PublisherTest : public ::testing::Test {
 protected:
  void publish(const Publisher::Wants& wants = [](const Channel&) { return true; }) {
    publisher_.encode(
        snapshot(), [&](const ChannelPtr& c) { announced_.push_back(c->topic); }, wants,
        [&](const MessagePtr& m) { messages_[m->channel->topic] = m; });
  }
  template <class Message>
  Message ros(const std::string& topic) {
    const auto at = messages_.find(topic);
    if (at == messages_.end()) {
      ADD_FAILURE() << "no message on " << topic;
      return {};
    }
    EXPECT_EQ(at->second->channel->encoding, Encoding::kCdr);
    EXPECT_EQ(at->second->channel->type, ros::type_text<Message>().name);
    const auto message = ros::from_cdr<Message>(at->second->octets);
    EXPECT_TRUE(message) << topic;
    return message.value_or(Message());
  }
  json json_of(const std::string& topic) {
    const auto& octets = messages_.at(topic)->octets;
    return json::parse(octets.begin(), octets.end());
  }

  Publisher publisher_;
  std::vector<std::string> announced_;
  std::map<std::string, MessagePtr> messages_;
};

TEST_F(PublisherTest, EveryChannelHasItsMessage) {
  publish();
  EXPECT_THAT(announced_,
              ElementsAre("/coslam/cam_0/pose", "/coslam/cam_0/odom", "/coslam/cam_0/path", "/coslam/cam_0/key_frames",
                          "/coslam/cam_0/tracks", "/coslam/far/pose", "/coslam/far/odom", "/coslam/far/path",
                          "/coslam/far/key_frames", "/coslam/far/tracks"));
  for (const ChannelPtr& c : publisher_.channels()) {
    const bool none =
        c->topic.starts_with("/coslam/far/") && !c->topic.ends_with("/pose") && !c->topic.ends_with("/odom");
    EXPECT_EQ(messages_.contains(c->topic), !none) << c->topic;
    EXPECT_FALSE(c->schema.empty());
  }
  announced_.clear();
  publish();
  EXPECT_TRUE(announced_.empty()) << "once";
}

TEST_F(PublisherTest, NothingIsMadeThatNobodyWants) {
  publish([](const Channel& c) { return c.topic == "/tf"; });
  EXPECT_EQ(messages_.size(), 1U);
  EXPECT_TRUE(messages_.contains("/tf"));
}

TEST_F(PublisherTest, FramesHangInEachOther) {
  publish();
  const auto tf = ros<ros::TFMessage>("/tf");
  ASSERT_EQ(tf.transforms.size(), 6U);
  std::vector<std::string> frames;
  for (const auto& t : tf.transforms) frames.push_back(t.header.frame_id + " " + t.child_frame_id);
  EXPECT_THAT(frames,
              ElementsAre("map cam_0/odom", "cam_0/odom cam_0/base_link", "cam_0/base_link cam_0/camera_optical_frame",
                          "map_5 far/odom", "far/odom far/base_link", "far/base_link far/camera_optical_frame"));
  EXPECT_EQ(tf.transforms[2].header.stamp.sec, 2);
  EXPECT_EQ(tf.transforms[2].header.stamp.nanosec, 400'000'000U);
  // One after the other they say where the camera is in the map; base_link is there too.
  const Rigid3 map_from_base = rigid_of(tf.transforms[0].transform) * rigid_of(tf.transforms[1].transform);
  const Rigid3 map_from_cam = map_from_base * rigid_of(tf.transforms[2].transform);
  EXPECT_LT(local(map_from_cam, camera_pose().inverse()).norm(), 1e-12);
  EXPECT_EQ(map_from_base.translation, map_from_cam.translation);
  EXPECT_LT(local(rigid_of(tf.transforms[0].transform), camera_pose().inverse() * cam_from_odom()).norm(), 1e-12);
}

// REP 103: a body's x is ahead, y left, z up; a camera's x right, y down, z ahead.
TEST_F(PublisherTest, ABodyLooksAheadAlongX) {
  const Eigen::Quaterniond base_from_cam = ros::base_from_optical().rotation;
  EXPECT_LT((base_from_cam * Eigen::Vector3d::UnitX() + Eigen::Vector3d::UnitY()).norm(), 1e-12);
  EXPECT_LT((base_from_cam * Eigen::Vector3d::UnitY() + Eigen::Vector3d::UnitZ()).norm(), 1e-12);
  EXPECT_LT((base_from_cam * Eigen::Vector3d::UnitZ() - Eigen::Vector3d::UnitX()).norm(), 1e-12);
}

TEST_F(PublisherTest, PosesInTheMapAndInOdomAreOfTheBody) {
  publish();
  const auto pose = ros<ros::PoseWithCovarianceStamped>("/coslam/cam_0/pose");
  EXPECT_EQ(pose.header.frame_id, "map");
  EXPECT_NEAR(pose.pose.pose.position.x, 1, 1e-12);
  // It looks along x of the map with y down: its left is z.
  const auto& q = pose.pose.pose.orientation;
  const Eigen::Quaterniond map_from_base(q.w, q.x, q.y, q.z);
  EXPECT_LT((map_from_base * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitX()).norm(), 1e-12);
  EXPECT_LT((map_from_base * Eigen::Vector3d::UnitZ() + Eigen::Vector3d::UnitY()).norm(), 1e-12);
  EXPECT_NEAR(pose.pose.covariance[0], 0.01, 1e-6);
  EXPECT_NEAR(pose.pose.covariance[35], 0.01, 1e-6);
  EXPECT_EQ(messages_.at("/coslam/cam_0/pose")->t_ns, 2'400'000'000);
  EXPECT_EQ(ros<ros::PoseWithCovarianceStamped>("/coslam/far/pose").header.frame_id, "map_5");
  EXPECT_GT(ros<ros::PoseWithCovarianceStamped>("/coslam/far/pose").pose.covariance[0], 1e5) << "nobody knows it";

  const auto odom = ros<ros::Odometry>("/coslam/cam_0/odom");
  EXPECT_EQ(odom.header.frame_id, "cam_0/odom");
  EXPECT_EQ(odom.child_frame_id, "cam_0/base_link");
  EXPECT_NEAR(odom.pose.pose.position.x, cam_from_odom().center().x(), 1e-12);
  EXPECT_NEAR(odom.pose.covariance[0], 0.01, 1e-6);
  EXPECT_NEAR(odom.twist.twist.linear.x, 1, 1e-12) << "ahead";
  EXPECT_NEAR(odom.twist.twist.angular.z, -0.5, 1e-12) << "about down";
  EXPECT_NEAR(odom.twist.covariance[0], 2 * 0.01 / (0.1 * 0.1), 1e-4);
  EXPECT_EQ(messages_.at("/coslam/cam_0/odom")->t_ns, 2'400'000'000);

  const auto path = ros<ros::Path>("/coslam/cam_0/path");
  ASSERT_EQ(path.poses.size(), 2U);
  EXPECT_EQ(path.poses[1].header.stamp.sec, 1);
  EXPECT_NEAR(path.poses[1].pose.position.z, 3, 1e-12);
  const auto key_frames = ros<ros::PoseArray>("/coslam/cam_0/key_frames");
  EXPECT_EQ(key_frames.header.frame_id, "map");
  ASSERT_EQ(key_frames.poses.size(), 1U);
  EXPECT_NEAR(key_frames.poses[0].position.z, 3, 1e-12);
}

TEST_F(PublisherTest, CloudsHaveTheirFields) {
  publish();
  const auto cloud = ros<ros::PointCloud2>("/coslam/map/points");
  EXPECT_EQ(cloud.header.frame_id, "map");
  ASSERT_EQ(cloud.width, 2U);
  std::map<std::string, std::uint32_t> offsets;
  for (const ros::PointField& f : cloud.point_fields) offsets[f.name] = f.offset;
  const auto at = [&](int point, const std::string& field, auto value) {
    std::memcpy(&value, &cloud.data[static_cast<std::size_t>(point) * cloud.point_step + offsets.at(field)],
                sizeof value);
    return value;
  };
  EXPECT_EQ(at(0, "x", 0.0F), 1);
  EXPECT_EQ(at(1, "z", 0.0F), 6);
  EXPECT_EQ(at(1, "sigma", 0.0F), 0.5F);
  EXPECT_EQ(at(0, "id", std::uint32_t()), 11U);
  EXPECT_EQ(at(1, "map", std::uint32_t()), 5U);
  EXPECT_EQ(at(0, "state", std::uint8_t()), 0);
  EXPECT_EQ(at(1, "state", std::uint8_t()), 1);
  EXPECT_EQ(at(0, "views", std::uint16_t()), 12);
  EXPECT_EQ(ros<ros::PointCloud2>("/coslam/map/moving").width, 1U);
}

TEST_F(PublisherTest, ObjectsAreBoxesInTheirMap) {
  publish();
  const auto markers = ros<ros::MarkerArray>("/coslam/objects").markers;
  std::vector<std::pair<int, std::string>> boxes;
  for (const ros::Marker& m : markers) {
    if (m.type == ros::Marker::kCube) boxes.emplace_back(m.id, m.header.frame_id);
  }
  EXPECT_THAT(boxes, ElementsAre(std::pair(2, "map"), std::pair(9, "map_5")));
  const auto detections = ros<ros::Detection3DArray>("/coslam/detections");
  ASSERT_EQ(detections.detections.size(), 1U);
  EXPECT_EQ(detections.detections[0].bbox.size.y, 1.7);
}

TEST_F(PublisherTest, TheStateIsAsTheDocsHaveIt) {
  publish();
  const json state = json_of("/coslam/state");
  EXPECT_EQ(state["t_s"], 2.5);
  EXPECT_EQ(state["run"], "0000000000c0ffee");
  EXPECT_EQ(state["groups"], json::parse(R"([["cam-0"],["far"]])"));
  EXPECT_EQ(state["links"], json::parse(R"([["cam-0","far",12]])"));
  for (const char* key : {"ms_per_set", "points", "moving_points", "objects", "maps", "key_frames", "memory_mib",
                          "frame_sets", "left_out"})
    EXPECT_TRUE(state["server"][key].is_number()) << key;
  EXPECT_EQ(state["result"], "");
  EXPECT_EQ(state["join"], "");
  const json& agent = state["agents"][0];
  EXPECT_EQ(agent["name"], "cam-0");
  EXPECT_EQ(agent["topic"], "/coslam/cam_0");
  EXPECT_EQ(agent["state"], "tracking");
  EXPECT_EQ(agent["frame"], "map");
  EXPECT_EQ(agent["fov"], json::parse("[640,480,500.0,500.0,320.0,240.0]"));
  ASSERT_EQ(agent["pose"].size(), 7U);
  EXPECT_NEAR(agent["pose"][0].get<double>(), 1, 1e-12);
  EXPECT_TRUE(agent["clock_offset_ms"].is_null());
  for (const char* key :
       {"alive", "camera", "map", "group", "why", "rate_hz", "frame_ms", "kB_up_per_s", "kB_down_per_s", "lag_s",
        "lost_percent", "account", "losses", "tracks", "bound", "scale_known"})
    EXPECT_TRUE(agent.contains(key)) << key;
  const json& lost = state["agents"][1];
  EXPECT_EQ(lost["state"], "lost");
  EXPECT_EQ(lost["why"], "no pose");
  EXPECT_EQ(lost["frame"], "map_5");
  EXPECT_TRUE(lost["pose"].is_null());
}

TEST_F(PublisherTest, EventsAndImagePlanes) {
  publish();
  EXPECT_EQ(json_of("/coslam/events"),
            json::parse(R"({"t_s":2.0,"kind":"lost","text":"far is lost","agents":["far"]})"));
  EXPECT_EQ(json_of("/coslam/cam_0/tracks"),
            json::parse(R"({"t_s":2.4,"width":640,"height":480,"tracks":[[3,10.2,20.5,1],[4,600.0,400.0,2]]})"));
}

}  // namespace
}  // namespace coslam::publisher_test
