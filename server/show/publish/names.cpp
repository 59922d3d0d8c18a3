// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/publish/names.h"

namespace coslam {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

std::string valid_name(const std::string& agent) {
  std::string name = agent.empty() || is_digit(agent.front()) ? "agent_" : "";
  for (const char c : agent) name += is_letter(c) || is_digit(c) ? c : '_';
  return name;
}

}  // namespace

const std::string& RosNames::ros_name(const std::string& agent) {
  const auto [at, is_new] = names_.try_emplace(agent);
  if (is_new) {
    const std::string name = valid_name(agent);
    at->second = name;
    for (int i = 2; !taken_.insert(at->second).second; ++i) at->second = name + "_" + std::to_string(i);
  }
  return at->second;
}

std::string frame_of(MapId map, MapId main) { return map == main ? "map" : "map_" + std::to_string(map.value); }

std::string odom_frame(const std::string& ros_name) { return ros_name + "/odom"; }

std::string base_frame(const std::string& ros_name) { return ros_name + "/base_link"; }

std::string camera_frame(const std::string& ros_name) { return ros_name + "/camera_optical_frame"; }

}  // namespace coslam
