// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <set>
#include <string>

#include "common/base/ids.h"

namespace coslam {

// Agents' names as ROS has names: letters, digits and '_', the first no digit. Two agents never have one.
class RosNames {
 public:
  const std::string& ros_name(const std::string& agent);

 private:
  std::map<std::string, std::string> names_;
  std::set<std::string> taken_;
};

// The root frame of a map: "map", or "map_ID" while it has not met the main one.
std::string frame_of(MapId map, MapId main);
// The frames of an agent: see docs/live.md.
std::string odom_frame(const std::string& ros_name);
std::string base_frame(const std::string& ros_name);
std::string camera_frame(const std::string& ros_name);

}  // namespace coslam
