// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/ros2_topic.h"

#include <algorithm>
#include <thread>
#include <utility>

#include "common/base/error.h"
#include "common/base/words.h"
#include "common/dataset/calibration.h"
#include "common/ros/cdr.h"
#include "common/ros/sensor_messages.h"
#include "common/ros/type.h"
#include "common/wire/ros_domain.h"

namespace coslam {
namespace {

constexpr std::chrono::milliseconds kLook{20}, kWait{100};
constexpr int kKept = 4;  // messages; the oldest makes room

int domain_of(const LiveTopic& topic) { return topic.domain ? *topic.domain : ros_domain_id().value_or(0); }

// Nodes send datagrams as large as they are, and images in bursts.
WireConfig listening(const LiveTopic& topic) {
  WireConfig wire = ros_wire(domain_of(topic), topic.interfaces);
  wire.max_message_bytes = kMostMessageBytes;
  wire.receive_buffer_bytes = 32U << 20U;
  return wire;
}

std::string patience_text() { return " within " + std::to_string(Ros2Topic::kPatience.count()) + " s"; }

}  // namespace

std::optional<int> ros2_domain(const std::string& name) {
  return name.starts_with(kRos2Scheme) ? std::optional(domain_of(live_topic(name))) : std::nullopt;
}

Ros2Topic::Ros2Topic(const std::string& name, std::vector<std::string> types, std::string like)
    : topic_(live_topic(name)),
      domain_(domain_of(topic_)),
      types_(std::move(types)),
      like_(std::move(like)),
      participant_(listening(topic_), "coslam-agent") {
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (type_.empty()) {
    for (const OfferedTopic& offered : participant_.offered()) {
      const std::string type = ros::type_of_dds(offered.type);
      if (offered.name == ros::dds_topic_of(topic_.topic) && std::ranges::count(types_, type) > 0) type_ = type;
    }
    if (!type_.empty()) break;
    if (std::chrono::steady_clock::now() > until) throw UserError(name + ": " + no_topic());
    std::this_thread::sleep_for(kLook);
  }
  open();
}

std::optional<TimeNs> Ros2Topic::take(const OctetInbox::OnOctets& read) {
  if (const auto came_ns = inbox_->take(read)) return came_ns;
  inbox_->wait(kWait);
  const auto came_ns = inbox_->take(read);
  // A node that comes back may offer less, or more.
  if (!came_ns && offered_reliably() != reliable_) open();
  return came_ns;
}

// What is sent again when it was lost, where all who write offer that. A reader that insists on it would not hear the
// others.
bool Ros2Topic::offered_reliably() const {
  bool all = true, any = false;
  for (const OfferedTopic& offered : participant_.offered()) {
    if (offered.name != ros::dds_topic_of(topic_.topic) || ros::type_of_dds(offered.type) != type_) continue;
    any = true;
    all = all && offered.reliable;
  }
  return any ? all : reliable_;
}

void Ros2Topic::open() {
  if (inbox_) missed_before_ += inbox_->missed();
  reliable_ = offered_reliably();
  inbox_.reset();
  const OctetTopic topic{ros::dds_topic_of(topic_.topic), ros::find_type(type_)->dds_name, reliable_, false, kKept};
  inbox_ = std::make_unique<OctetInbox>(participant_, topic);
}

std::string Ros2Topic::why_silent() const {
  const std::string qos = inbox_->unmatched_qos();
  if (inbox_->writers() == 0 && !qos.empty()) {
    return "who writes topic " + topic_.topic + " offers another QoS than is read here: its " + qos;
  }
  return "topic " + topic_.topic + " is there, but no message came" + patience_text();
}

std::string Ros2Topic::no_topic() const {
  const std::string domain = "ROS domain " + std::to_string(domain_);
  if (participant_.others().empty()) {
    return "no node was seen in " + domain + " at " + joined(topic_.interfaces, ", ") + patience_text() +
           ": nodes of another domain are heard with ?domain=N, those of other machines with ?interface=ADDRESS";
  }
  std::vector<std::string> types_here, seen;
  for (const OfferedTopic& offered : participant_.offered()) {
    const auto topic = ros::topic_of_dds(offered.name);
    const std::string type = ros::type_of_dds(offered.type);
    if (topic == topic_.topic) types_here.push_back(type);
    if (topic && type.find(like_) != type.npos) seen.push_back(*topic + " (" + type + ")");
  }
  seen.erase(std::unique(seen.begin(), seen.end()), seen.end());  // of writers that differ in what they offer
  const std::string seen_text = like_ + " topics seen: " + (seen.empty() ? "none" : joined(seen, ", "));
  if (types_here.empty()) return "there is no topic " + topic_.topic + " in " + domain + "; " + seen_text;
  return "topic " + topic_.topic + " in " + domain + " is of type " + joined(types_here, " and ") + ", but " +
         joined(types_, " or ") + " is read; " + seen_text;
}

ReadCalibration heard_camera(const std::string& name) {
  Ros2Topic topic(name, {ros::type_text<ros::CameraInfo>().name}, "CameraInfo");
  std::optional<ros::CameraInfo> info;
  const auto read = [&](std::span<const std::uint8_t> octets) { info = ros::from_cdr<ros::CameraInfo>(octets); };
  const auto until = std::chrono::steady_clock::now() + Ros2Topic::kPatience;
  while (!topic.take(read)) {
    if (std::chrono::steady_clock::now() > until) throw UserError(name + ": " + topic.why_silent());
  }
  if (!info) throw UserError(name + ": its first message is damaged");
  return read_calibration(*info, name);
}

}  // namespace coslam
