// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/wire/wire_config.h"
#include "deploy/coslam/doctor/finding.h"

// The ways out of this machine and the ports of a domain on it. Facts are looked up, judging them is pure.
namespace coslam::doctor {

struct Interface {
  std::string name;
  std::vector<std::string> addresses;  // IPv4
  unsigned index = 0;                  // index in the system
  bool up = false, carrier = false;    // switched on; with a cable or an access point
  bool loopback = false, multicast = false;
  int mtu = 0;
};
std::vector<Interface> look_at_interfaces();

// Whether the fleet's traffic goes over it, and why not.
struct Use {
  bool used = false;
  std::string why_not;
};
Use use_of(const Interface& interface, const WireConfig& wire);

Findings judge(const std::vector<Interface>& interfaces, const WireConfig& wire);

// Process that holds a port on which participants of the domain listen.
struct HeldPort {
  int participant = 0;
  std::string program;  // empty: of another user
  int pid = 0;
};
struct PortFacts {
  int domain = 0;
  bool multicast_bindable = true;
  std::vector<HeldPort> held;  // in their order
};
PortFacts look_at_ports(int domain);
Findings judge(const PortFacts& facts, const WireConfig& wire);

}  // namespace coslam::doctor
