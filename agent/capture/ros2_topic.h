// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/base/time.h"
#include "common/dataset/calibration.h"
#include "common/dataset/live_topic.h"
#include "common/wire/octet_inbox.h"
#include "common/wire/participant.h"

namespace coslam {

// The DDS domain of a source or calibration that is named ros2:/TOPIC; empty for others. Throws UserError.
std::optional<int> ros2_domain(const std::string& name);

// A topic of ROS 2 nodes at work. It is heard by a participant of its own, which only reads, so that what nodes say
// does not reach the fleet's. For one thread.
class Ros2Topic {
 public:
  // Time to wait for nodes: for the topic to appear, and then for its first message.
  static constexpr std::chrono::seconds kPatience{10};

  // Waits for the topic, with one of these types ("sensor_msgs/msg/Image"). Throws UserError, one sentence, when it
  // does not appear: what is there instead, of topics whose types contain `like`.
  Ros2Topic(const std::string& name, std::vector<std::string> types, std::string like);

  const std::string& type() const { return type_; }
  // Waits up to 0.1 s for a message and hands it to `read`; see OctetInbox::take().
  std::optional<TimeNs> take(const OctetInbox::OnOctets& read);
  std::uint64_t missed() const { return missed_before_ + inbox_->missed(); }  // see OctetInbox
  // Why no message came that could be used, as the end of a sentence.
  std::string why_silent() const;

 private:
  std::string no_topic() const;
  bool offered_reliably() const;
  void open();

  const LiveTopic topic_;
  const int domain_;
  const std::vector<std::string> types_;
  const std::string like_;
  Participant participant_;
  std::string type_;
  bool reliable_ = false;
  std::uint64_t missed_before_ = 0;
  std::unique_ptr<OctetInbox> inbox_;
};

// The camera of ros2:/TOPIC, from the first sensor_msgs/msg/CameraInfo that comes. Throws UserError.
ReadCalibration heard_camera(const std::string& name);

}  // namespace coslam
