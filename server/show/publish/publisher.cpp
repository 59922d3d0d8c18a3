// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/publish/publisher.h"

#include <algorithm>
#include <utility>

#include "common/ros/messages.h"
#include "common/ros/type.h"
#include "server/show/publish/json.h"
#include "server/show/publish/ros_messages.h"

namespace coslam {
namespace {

template <class Message>
Channel ros_channel(std::string topic, Part part, std::size_t keep = 0) {
  const ros::TypeText& type = ros::type_text<Message>();
  return {std::move(topic), Encoding::kCdr, type.name, type.schema, part, keep};
}

Channel json_channel(std::string topic, std::string_view type, std::string_view schema, Part part,
                     std::size_t keep = 0) {
  return {std::move(topic), Encoding::kJson, type, schema, part, keep};
}

std::vector<std::uint8_t> octets_of(const std::string& text) { return {text.begin(), text.end()}; }

}  // namespace

Publisher::Publisher()
    : tf_(add(ros_channel<ros::TFMessage>("/tf", Part::kPoses))),
      points_(add(ros_channel<ros::PointCloud2>("/coslam/map/points", Part::kCloud, 1))),
      moving_(add(ros_channel<ros::PointCloud2>("/coslam/map/moving", Part::kMoving))),
      objects_(add(ros_channel<ros::MarkerArray>("/coslam/objects", Part::kMoving))),
      detections_(add(ros_channel<ros::Detection3DArray>("/coslam/detections", Part::kMoving))),
      state_(add(json_channel("/coslam/state", "coslam.State", kStateSchema, Part::kState, 1))),
      events_(add(json_channel("/coslam/events", "coslam.Event", kEventSchema, Part::kEvents, kKeptEvents))) {}

ChannelPtr Publisher::add(Channel channel) {
  channels_.push_back(std::make_shared<const Channel>(std::move(channel)));
  return channels_.back();
}

const Publisher::OfAgent& Publisher::of_agent(const std::string& agent, const Announce& announce) {
  const auto [at, is_new] = agents_.try_emplace(agent);
  if (is_new) {
    const std::string prefix = "/coslam/" + names_.ros_name(agent);
    at->second = {add(ros_channel<ros::PoseWithCovarianceStamped>(prefix + "/pose", Part::kPoses)),
                  add(ros_channel<ros::Odometry>(prefix + "/odom", Part::kPoses)),
                  add(ros_channel<ros::Path>(prefix + "/path", Part::kPaths, 1)),
                  add(ros_channel<ros::PoseArray>(prefix + "/key_frames", Part::kPaths, 1)),
                  add(json_channel(prefix + "/tracks", "coslam.Tracks", kTracksSchema, Part::kTracks, 1))};
    const OfAgent& made = at->second;
    for (const ChannelPtr& c : {made.pose, made.odom, made.path, made.key_frames, made.tracks}) announce(c);
  }
  return at->second;
}

void Publisher::encode(const Snapshot& snapshot, const Announce& announce, const Wants& wants, const Put& put) {
  // make: octets of a message, when somebody wants it.
  const auto tell = [&](const ChannelPtr& channel, TimeNs t_ns, auto&& make) {
    if (wants(*channel)) put(std::make_shared<const PublicMessage>(PublicMessage{channel, t_ns, make()}));
  };
  if (const auto& s = snapshot.state) {
    rates_.see(*s);
    for (const PublicAgent& a : s->agents) of_agent(a.facts.name, announce);
    tell(state_, s->t_ns, [&] { return octets_of(state_json(*s, rates_, names_)); });
  }
  for (const PublicEvent& e : snapshot.events) tell(events_, e.t_ns, [&] { return octets_of(event_json(e)); });
  if (const auto& p = snapshot.poses) {
    tell(tf_, p->t_ns, [&] { return ros::to_cdr(tf_message(*p, names_)); });
    for (const PublicPose& c : p->cameras) {
      const OfAgent& to = of_agent(c.agent, announce);
      tell(to.pose, c.capture_ns, [&] { return ros::to_cdr(pose_in_map(c, p->main)); });
      tell(to.odom, c.capture_ns, [&] { return ros::to_cdr(odometry(c, names_)); });
    }
  }
  if (const auto& m = snapshot.moving) {
    tell(moving_, m->t_ns, [&] { return ros::to_cdr(moving_cloud(*m)); });
    tell(objects_, m->t_ns, [&] { return ros::to_cdr(object_markers(*m)); });
    tell(detections_, m->t_ns, [&] { return ros::to_cdr(object_detections(*m)); });
  }
  if (const auto& c = snapshot.cloud) tell(points_, c->t_ns, [&] { return ros::to_cdr(static_cloud(*c)); });
  if (const auto& p = snapshot.paths) {
    for (const PublicPath& c : p->cameras) {
      const OfAgent& to = of_agent(c.agent, announce);
      tell(to.path, p->t_ns, [&] { return ros::to_cdr(path(c, *p)); });
      tell(to.key_frames, p->t_ns, [&] { return ros::to_cdr(key_frames(c, *p)); });
    }
  }
  if (const auto& t = snapshot.tracks) {
    for (const PublicImage& c : t->cameras)
      tell(of_agent(c.agent, announce).tracks, c.capture_ns, [&] { return octets_of(tracks_json(c)); });
  }
}

}  // namespace coslam
