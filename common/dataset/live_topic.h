// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

// Topics of ROS 2 nodes at work, which users name ros2:/TOPIC, ros2:/TOPIC?domain=N or ros2:/TOPIC?interface=ADDRESS.
namespace coslam {

inline constexpr std::string_view kRos2Scheme = "ros2:";

struct LiveTopic {
  std::string topic;                                    // begins with '/'
  std::optional<int> domain;                            // DDS domain, 0 to 232
  std::vector<std::string> interfaces = {"127.0.0.1"};  // addresses of this host on which the nodes are
};

// Parses a name that begins with kRos2Scheme. Throws UserError: it has another form.
LiveTopic live_topic(const std::string& name);

}  // namespace coslam
