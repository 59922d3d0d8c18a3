// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/wire/wire_options.h"
#include "server/show/bridge/px4_odometry.h"

namespace coslam {

struct BridgeConfig {
  int domain = -1;                                      // domain of the ROS 2 nodes; -1: ROS_DOMAIN_ID, else 0
  std::vector<std::string> interfaces = {"127.0.0.1"};  // on which these are; empty: all
  MapLevel map;
  Px4Config px4;
};

template <class V>
void describe(V& v, BridgeConfig& c) {
  v.field("domain", c.domain, {-1, 232},
          "DDS domain of the ROS 2 nodes; -1: that of the variable ROS_DOMAIN_ID, else 0");
  v.field("interfaces", c.interfaces, "IPv4 addresses of this host on which ROS 2 is spoken; empty: all");
  v.section("map", c.map);
  v.section("px4", c.px4);
}

// All keys of bridge.yaml.
struct BridgeOptions {
  WireConfig wire;  // network of the fleet
  BridgeConfig bridge;
};

template <class V>
void describe(V& v, BridgeOptions& o) {
  v.section("wire", o.wire);
  v.section("bridge", o.bridge);
}

}  // namespace coslam
