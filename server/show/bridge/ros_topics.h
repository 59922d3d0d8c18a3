// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/model/public_sample.h"
#include "common/wire/octet_topic.h"
#include "common/wire/participant.h"

namespace coslam {

// The DDS topic by which ROS 2 nodes know a public one, with the QoS that fits what it is; JSON becomes a
// std_msgs/msg/String. Empty: a type that is not known here.
std::optional<OctetTopic> ros_topic(const std::string& topic, const std::string& type);
// Octets of a sample on its ROS 2 topic.
std::vector<std::uint8_t> ros_octets(const PublicSample& sample);

// Public messages as topics of ROS 2 in a domain: each begins with its first message. Not thread-safe.
class RosTopics {
 public:
  // The participant outlives it.
  explicit RosTopics(Participant& participant) : participant_(participant) {}

  void put(const PublicSample& sample);
  std::size_t topics() const { return writers_.size(); }

 private:
  static constexpr std::size_t kMostTopics = 512;

  OctetWriter* writer_of(const PublicSample& sample);

  Participant& participant_;
  std::map<std::string, std::unique_ptr<OctetWriter>> writers_;  // null: refused
};

}  // namespace coslam
