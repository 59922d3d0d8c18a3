// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/time.h"
#include "server/show/publish/snapshot.h"

// Public messages and their channels, independent of the transport: see docs/live.md for the topics.
namespace coslam {

enum class Encoding : std::uint8_t { kCdr, kJson };

struct Channel {
  std::string topic;
  Encoding encoding = Encoding::kJson;
  std::string_view type;    // ROS 2 type, "nav_msgs/msg/Odometry"; for JSON, a name of ours
  std::string_view schema;  // definition of the type: ros2msg, or a JSON schema
  PartSet part;             // part of a snapshot that its messages are made of
  std::size_t keep = 0;     // newest messages that somebody who comes later wants too
};
using ChannelPtr = std::shared_ptr<const Channel>;

struct PublicMessage {
  ChannelPtr channel;
  TimeNs t_ns = 0;  // capture time
  std::vector<std::uint8_t> octets;
};
using MessagePtr = std::shared_ptr<const PublicMessage>;

// Carries messages to the public. All functions but parts() are called from one thread, that of the publication, and
// must not wait.
class PublicSink {
 public:
  PublicSink() = default;
  virtual ~PublicSink() = default;
  PublicSink(const PublicSink&) = delete;
  PublicSink& operator=(const PublicSink&) = delete;

  // A channel that there is from now on; before any message of it.
  virtual void announce(const ChannelPtr& channel) = 0;
  // Whether somebody reads it now: nothing is made that nobody wants.
  virtual bool wants(const Channel& channel) const = 0;
  virtual void put(const MessagePtr& message) = 0;

  // Parts that it wants now, for messages or to see them as they are. From any thread, at once.
  virtual PartSet parts() const = 0;
  virtual void see(const Snapshot&) {}
};

}  // namespace coslam
