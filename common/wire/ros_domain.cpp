// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/ros_domain.h"

#include <algorithm>
#include <cstdlib>

#include "common/base/error.h"
#include "common/base/text.h"

namespace coslam {

std::optional<int> ros_domain_id() {
  const char* text = std::getenv("ROS_DOMAIN_ID");
  if (text == nullptr || *text == '\0') return std::nullopt;
  const auto number = parse_integer(text);
  if (!number || *number < 0 || *number > 232) {
    throw UserError("ROS_DOMAIN_ID is '" + std::string(text) + "', which is no DDS domain (0 to 232)");
  }
  return static_cast<int>(*number);
}

WireConfig ros_wire(int domain, const std::vector<std::string>& interfaces) {
  const auto is_loopback = [](const std::string& address) { return address.starts_with("127."); };
  const bool on_loopback = !interfaces.empty() && std::ranges::all_of(interfaces, is_loopback);
  WireConfig wire = on_loopback ? loopback_config(domain) : WireConfig{.domain = domain};
  wire.interfaces = interfaces;
  wire.bulk_bytes_per_s = 0;
  wire.own_host = on_loopback;
  if (on_loopback)
    wire.max_message_bytes = kMostMessageBytes;  // nothing is lost within a machine, and large ones cost less
  return wire;
}

}  // namespace coslam
