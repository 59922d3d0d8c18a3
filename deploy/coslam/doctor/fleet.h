// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/wire/ipv4_endpoint.h"
#include "deploy/coslam/doctor/finding.h"
#include "deploy/coslam/doctor/network.h"

// Finds out which participants are heard in the fleet's domain and in neighbouring ones, and whether messages to them
// arrive. Looking up facts is separate from judging them, which is pure.
namespace coslam::doctor {

// Questions to one address of a participant, and what came back.
struct Road {
  Ipv4Endpoint to;
  int asked = 0, answered = 0;                   // answers to where the question came from
  int asked_for_port = 0, answered_at_port = 0;  // answers to a port of the domain, as samples come
  int all_asked() const { return asked + asked_for_port; }
  int all_answered() const { return answered + answered_at_port; }
  double least_ms = 0;       // minimum round trip
  double clock_ahead_s = 0;  // offset of that host's clock to this one's
};

enum class Seal : std::uint8_t { kNone, kOurs };

// A participant of DDS.
struct Voice {
  std::string name;           // name in its announcement
  std::uint32_t address = 0;  // address that it sends from
  bool announced = false;     // heard without being asked
  bool by_multicast = false;  // other hosts here hear it too
  bool heard_ours = false;    // answered the question to all
  Seal seal = Seal::kNone;
  std::optional<std::uint16_t> protocol;  // protocol of those that answered
  std::vector<Road> roads;
};

// A host that was named.
struct Called {
  std::string name;
  std::string problem;  // why it has no address; empty: it has one
  std::vector<std::uint32_t> addresses;
  bool heard = false;        // somebody of the fleet answers there
  std::optional<int> error;  // error of the network, as errno
};

struct Neighbour {
  int domain = 0;
  std::string name;
  std::uint32_t address = 0;
  friend auto operator<=>(const Neighbour&, const Neighbour&) = default;
};

struct FleetFacts {
  int domain = 0;
  std::string key_file;             // empty: none, or not fit
  std::vector<Interface> asked_by;  // multicast
  std::set<unsigned> came_back;     // interfaces on which our own did
  std::uint16_t own_port = 0;       // port of the domain, where answers are expected
  std::vector<Voice> voices;        // in the domain
  std::vector<Called> called;
  std::set<Neighbour> next_door;             // other domains
  std::set<std::uint32_t> sealed_by_others;  // addresses of participants in the domain that cannot be read
  bool by_name_alone = false;                // the settings call hosts by name, and nobody by multicast
};

// The ear: listens and asks for three seconds.
// `named`: hosts that are asked besides the peers of the settings.
FleetFacts listen_to_fleet(const WireConfig& wire, const std::vector<Interface>& interfaces,
                           const std::vector<std::string>& named);

Findings judge(const FleetFacts& facts);

}  // namespace coslam::doctor
