// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/bridge/ros_topics.h"

#include <string_view>

#include "common/base/error.h"
#include "common/base/log.h"
#include "common/ros/cdr.h"
#include "common/ros/messages.h"
#include "common/ros/type.h"

namespace coslam {
namespace {

// Reliable writers serve readers of either kind; a best-effort one would stay unheard by most nodes' default.
struct Delivery {
  bool reliable = true, late_joiners = false;
  int depth = 5;
};

Delivery delivery_of(const std::string& topic, std::string_view type) {
  constexpr int kKeptEvents = 256, kTransforms = 100;
  const auto ends = [&](std::string_view suffix) { return topic.ends_with(suffix); };
  if (type == ros::type_text<ros::VehicleOdometry>().name) return {.reliable = false, .depth = 1};
  if (topic == "/tf_static") return {.late_joiners = true, .depth = kTransforms};
  if (topic == "/tf") return {.depth = kTransforms};
  if (ends("/map/points") || ends("/path") || ends("/key_frames") || ends("/state"))
    return {.late_joiners = true, .depth = 1};
  if (ends("/events")) return {.late_joiners = true, .depth = kKeptEvents};
  return {};
}

}  // namespace

std::optional<OctetTopic> ros_topic(const std::string& topic, const std::string& type) {
  const std::string ros_type = type == kJsonType ? ros::type_text<ros::String>().name : type;
  const ros::TypeText* text = ros::find_type(ros_type);
  if (text == nullptr || !topic.starts_with('/')) return std::nullopt;
  const Delivery delivery = delivery_of(topic, ros_type);
  return OctetTopic{ros::dds_topic_of(topic), text->dds_name, delivery.reliable, delivery.late_joiners, delivery.depth};
}

std::vector<std::uint8_t> ros_octets(const PublicSample& sample) {
  if (sample.type != kJsonType) return sample.octets;
  return ros::to_cdr(ros::String{{sample.octets.begin(), sample.octets.end()}});
}

OctetWriter* RosTopics::writer_of(const PublicSample& sample) {
  const auto known = writers_.find(sample.topic);
  if (known != writers_.end()) return known->second.get();
  if (writers_.size() == kMostTopics) return nullptr;
  if (writers_.size() + 1 == kMostTopics) log_warn("more topics than are handed on: " + sample.topic + " is the last");
  auto& writer = writers_[sample.topic];
  const auto topic = ros_topic(sample.topic, sample.type);
  if (topic) {
    writer = std::make_unique<OctetWriter>(participant_, *topic);
  } else {
    log_warn("topic " + sample.topic + " is of a type that is not known here: " + sample.type);
  }
  return writer.get();
}

void RosTopics::put(const PublicSample& sample) {
  if (OctetWriter* writer = writer_of(sample)) writer->write(ros_octets(sample));
}

}  // namespace coslam
