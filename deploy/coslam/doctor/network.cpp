// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/doctor/network.h"

#include <algorithm>

#include "common/base/words.h"
#include "common/wire/ports.h"

namespace coslam::doctor {
namespace {

// IPv4 and UDP.
constexpr int kHeaders = 28;

Finding judge_used(const Interface& i, const WireConfig& wire) {
  const std::string is = joined(i.addresses) + ", MTU " + std::to_string(i.mtu);
  if (i.mtu < wire.max_message_bytes + kHeaders) {
    const int fits = i.mtu - kHeaders;
    return {Grade::kWarn, i.name,
            is + ": datagrams of up to " + std::to_string(wire.max_message_bytes + kHeaders) +
                " octets are cut in two, and the loss of one part loses both",
            "wire.max_message_bytes=" + std::to_string(fits) + " on all machines"};
  }
  if (!i.multicast && !i.loopback && wire.peers.empty()) {
    return {Grade::kWarn, i.name, is + ": it carries no multicast, by which agents and server find each other",
            "wire.peers=[HOST] on agents, with the server's address"};
  }
  return {Grade::kOk, i.name, is};
}

// Of one that is left aside: what would bring it into use.
std::string mend_of(const Interface& i) {
  if (!i.up) return "sudo ip link set " + i.name + " up";
  if (!i.carrier) return "plug in its cable, or join its network";
  return "sudo dhclient " + i.name;
}

bool reaches_beyond(const Interface& i) { return !i.loopback; }

std::string port_of(const HeldPort& held, int domain) {
  return "UDP " + std::to_string(unicast_port(domain, held.participant)) + " is held by " +
         (held.program.empty() ? "a program of another user"
                               : held.program + " (process " + std::to_string(held.pid) + ")");
}

bool is_our_port(const HeldPort& held) { return held.program.starts_with("coslam"); }

}  // namespace

Use use_of(const Interface& i, const WireConfig& wire) {
  if (i.addresses.empty() || !i.up || !i.carrier) {
    return {false, !i.up ? "it is down" : !i.carrier ? "it has no carrier" : "it has no IPv4 address"};
  }
  const auto chosen = [&](const std::string& address) {
    return std::ranges::find(wire.interfaces, address) != wire.interfaces.end();
  };
  if (!wire.interfaces.empty() && std::ranges::none_of(i.addresses, chosen)) {
    return {false, "wire.interfaces names " + joined(wire.interfaces)};
  }
  return {true, {}};
}

Findings judge(const std::vector<Interface>& interfaces, const WireConfig& wire) {
  const auto used = [&](const Interface& i) { return use_of(i, wire).used; };
  const bool alone = !wire.interfaces.empty() &&
                     std::ranges::any_of(interfaces, [&](const Interface& i) { return i.loopback && used(i); });
  const bool reaches =
      std::ranges::any_of(interfaces, [&](const Interface& i) { return reaches_beyond(i) && used(i); });
  Findings out;
  for (const std::string& address : wire.interfaces) {
    const auto has = [&](const Interface& i) { return std::ranges::find(i.addresses, address) != i.addresses.end(); };
    if (std::ranges::any_of(interfaces, has)) continue;
    out.push_back({Grade::kFail, "interfaces", "wire.interfaces names " + address + ", which this machine has not",
                   "ip -brief address shows what it has"});
  }
  for (const Interface& i : interfaces) {
    const Use use = use_of(i, wire);
    if (use.used) {
      out.push_back(judge_used(i, wire));
    } else if (reaches || alone || i.loopback) {
      out.push_back({Grade::kOk, i.name, "left aside: " + use.why_not});
    } else {
      out.push_back({Grade::kFail, i.name, use.why_not + ", and no other leads out of this machine", mend_of(i)});
    }
  }
  if (!reaches && !alone && std::ranges::none_of(interfaces, reaches_beyond)) {
    out.push_back({Grade::kFail, "interfaces", "none leads out of this machine", "ip -brief link shows what it has"});
  }
  return out;
}

Findings judge(const PortFacts& facts, const WireConfig& wire) {
  const std::string subject = "ports", number = std::to_string(facts.domain);
  const std::string other = "--domain N with another number on all machines";
  if (!facts.multicast_bindable) {
    return {{Grade::kFail, subject,
             "UDP " + std::to_string(multicast_port(facts.domain)) + ", where announcements in domain " + number +
                 " arrive, is held by a program that shares it with nobody",
             other}};
  }
  if (std::ssize(facts.held) >= kMostPerHost) {
    return {{Grade::kFail, subject,
             "no UDP port of domain " + number + " is free: " + port_of(facts.held.front(), facts.domain), other}};
  }
  const auto foreign = std::ranges::find_if_not(facts.held, is_our_port);
  const bool crowded = std::ssize(facts.held) >= wire.peer_range;
  if (foreign != facts.held.end()) {
    return {{Grade::kWarn, subject,
             port_of(*foreign, facts.domain) + ", no program of the fleet, in its domain " + number +
                 (crowded ? ": who calls this machine by name cannot find a further one" : ""),
             other}};
  }
  const std::string free = "UDP " + std::to_string(multicast_port(facts.domain)) + " to " +
                           std::to_string(last_port(facts.domain)) + " of domain " + number + ": ";
  const std::string held = facts.held.empty() ? "free"
                                              : std::to_string(facts.held.size()) +
                                                    (facts.held.size() == 1 ? " participant of the fleet here"
                                                                            : " participants of the fleet here");
  return {{Grade::kOk, subject, free + held}};
}

}  // namespace coslam::doctor
