// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <optional>
#include <vector>

#include "common/base/error.h"
#include "common/flow/clock.h"
#include "common/wire/addresses.h"
#include "common/wire/guard.h"
#include "common/wire/participant.h"
#include "common/wire/peer_names.h"
#include "common/wire/ports.h"
#include "deploy/coslam/doctor/fleet.h"
#include "deploy/coslam/doctor/hearing.h"
#include "deploy/coslam/doctor/udp.h"

namespace coslam::doctor {
namespace {

using Clock = std::chrono::steady_clock;
using Octets = std::span<const std::uint8_t>;
using std::chrono::milliseconds;

// Everybody announces itself once a second, unless set otherwise.
constexpr milliseconds kListen{3200}, kAskEvery{200}, kAskUntil{2800}, kDoubtAfter{1400};
constexpr int kAskAllEvery = 3;  // rounds

// A socket, and the domain whose announcements it hears.
struct Listener {
  Udp socket;
  int domain = 0;
  bool multicast = false;
};

class Ear {
 public:
  Ear(const WireConfig& wire, const std::vector<Interface>& interfaces, const std::vector<std::string>& named,
      FleetFacts& facts)
      : wire_(wire), facts_(facts), hearing_(facts) {
    for (const Interface& i : interfaces) {
      if (use_of(i, wire).used && i.multicast) facts_.asked_by.push_back(i);
    }
    take_key();
    open_sockets();
    for (const auto* hosts : {&wire.peers, &named}) {
      for (const std::string& host : *hosts) call_host(host);
    }
  }

  void run() {
    const Instant start = Clock::now();
    Instant next = start;
    for (int round = 0; Clock::now() - start < kListen;) {
      if (Clock::now() >= next && Clock::now() - start < kAskUntil) {
        ask(round++, Clock::now() - start > kDoubtAfter);
        next += kAskEvery;
      }
      hear(milliseconds(20));
    }
  }

 private:
  void take_key() {
    if (wire_.key_file.empty()) return;
    try {
      sealer_.emplace(load_fleet_key(wire_.key_file, wire_.domain));
      facts_.key_file = wire_.key_file;
    } catch (const UserError&) {
      // Told by the look at the file.
    }
  }

  // One for the announcements of each domain, and the ports of a participant that is none.
  void open_sockets() {
    for (int domain = 0; domain <= kMostDomain; ++domain) {
      Listener listener{Udp(), domain, true};
      if (!listener.socket.bind(multicast_port(domain), Udp::Share::kYes)) continue;
      for (const Interface& i : facts_.asked_by) listener.socket.join(kMulticastGroup, i.index);
      listeners_.push_back(std::move(listener));
    }
    for (int participant = 0; participant < kMostPerHost && facts_.own_port == 0; ++participant) {
      Listener listener{Udp(), wire_.domain, false};
      if (!listener.socket.bind(unicast_port(wire_.domain, participant))) continue;
      facts_.own_port = static_cast<std::uint16_t>(unicast_port(wire_.domain, participant));
      listeners_.push_back(std::move(listener));
    }
    listeners_.push_back({Udp(), wire_.domain, false});
    asks_ = listeners_.size() - 1;
  }

  void call_host(const std::string& name) {
    Called called{.name = name};
    try {
      for (const std::string& address : addresses_of_peer(name)) called.addresses.push_back(*address_of(address));
    } catch (const UserError& error) {
      called.problem = error.what();
    }
    for (const std::uint32_t address : called.addresses) call(address);
    facts_.called.push_back(std::move(called));
  }

  // Whoever of the domain may be there; the doctor itself is nobody.
  void call(std::uint32_t address) {
    const std::vector<std::string> local = local_addresses();
    const bool is_local = std::ranges::find(local, text_of(address)) != local.end();
    for (int i = 0; i < wire_.peer_range; ++i) {
      const auto port = static_cast<std::uint16_t>(unicast_port(wire_.domain, i));
      if (!is_local || port != facts_.own_port) hearing_.call({address, port});
    }
  }

  const Udp& asker() const { return listeners_[asks_].socket; }

  void ask(int round, bool doubtful) {
    for (const Ipv4Endpoint& endpoint : hearing_.endpoints()) {
      put(Hearing::Way::kBack, endpoint, sealer_.has_value());
      if (facts_.own_port != 0) put(Hearing::Way::kToPort, endpoint, sealer_.has_value());
      // It may have no key.
      if (sealer_ && doubtful && hearing_.is_silent(endpoint)) put(Hearing::Way::kBack, endpoint, false);
    }
    if (round % kAskAllEvery != 0) return;
    const Ipv4Endpoint all{*address_of(kMulticastGroup), static_cast<std::uint16_t>(multicast_port(wire_.domain))};
    for (const Interface& i : facts_.asked_by) {
      listeners_[asks_].socket.send_by(i.index);
      put(Hearing::Way::kMulticast, all, sealer_.has_value());
    }
  }

  void put(Hearing::Way way, const Ipv4Endpoint& to, bool sealed) {
    EchoRequest request{hearing_.ask(way, to, Clock::now()), 0};
    if (way == Hearing::Way::kToPort) request.answer_port = facts_.own_port;
    const EchoOctets octets = encode(request);
    std::vector<std::uint8_t> datagram(octets.begin(), octets.end());
    if (sealed) sealer_->seal(octets, datagram);
    if (!asker().send(datagram, to) && way != Hearing::Way::kMulticast) hearing_.undelivered(to, errno);
  }

  void hear(milliseconds patience) {
    std::vector<pollfd> wanted;
    for (const Listener& listener : listeners_) wanted.push_back({listener.socket.handle(), POLLIN, 0});
    if (poll(wanted.data(), wanted.size(), static_cast<int>(patience.count())) <= 0) return;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      if (wanted[i].revents == 0) continue;
      while (const auto lost = listeners_[i].socket.undelivered()) hearing_.undelivered(lost->to, lost->error);
      while (const auto received = listeners_[i].socket.receive()) take(listeners_[i], *received);
    }
  }

  void take(const Listener& listener, const Udp::Received& received) {
    const Octets octets = received.octets;
    if (is_rtps(octets) || octets.size() == kEchoBytes) return read(listener, received, octets, Seal::kNone);
    if (octets.size() < kSealBytes) return;
    if (Opener* opener = opener_of(listener.domain)) {
      const Opened opened = opener->open(octets);
      if (!opened.refused) return read(listener, received, opened.payload, Seal::kOurs);
      if (*opened.refused == Rejection::kReplayed) return;
    }
    if (listener.domain == wire_.domain) {
      facts_.sealed_by_others.insert(received.from.address);
    } else {
      facts_.next_door.insert({listener.domain, {}, received.from.address});
    }
  }

  void read(const Listener& listener, const Udp::Received& received, Octets octets, Seal seal) {
    const std::uint32_t from = received.from.address;
    if (const auto request = decode_echo_request(octets)) {
      if (hearing_.is_own(*request)) facts_.came_back.insert(received.interface);
    } else if (const auto answer = decode_echo_answer(octets)) {
      hearing_.answered(*answer, from, seal, Clock::now(), time_of_day_ns());
    } else if (const auto announcement = read_announcement(octets)) {
      if (listener.domain == wire_.domain) {
        hearing_.announced(*announcement, from, seal, listener.multicast);
      } else {
        facts_.next_door.insert({listener.domain, announcement->name, from});
      }
    }
  }

  // Null: there is no key. Each domain has one of its own.
  Opener* opener_of(int domain) {
    if (!sealer_) return nullptr;
    auto& opener = openers_[static_cast<std::size_t>(domain)];
    if (!opener) opener = std::make_unique<Opener>(load_fleet_key(wire_.key_file, domain));
    return opener.get();
  }

  const WireConfig& wire_;
  FleetFacts& facts_;
  Hearing hearing_;
  std::vector<Listener> listeners_;
  std::size_t asks_ = 0;  // the listener from which questions go out
  std::optional<Sealer> sealer_;
  std::array<std::unique_ptr<Opener>, kMostDomain + 1> openers_;
};

}  // namespace

FleetFacts listen_to_fleet(const WireConfig& wire, const std::vector<Interface>& interfaces,
                           const std::vector<std::string>& named) {
  FleetFacts facts;
  facts.domain = wire.domain;
  facts.by_name_alone = !wire.peers.empty();
  Ear(wire, interfaces, named, facts).run();
  return facts;
}

}  // namespace coslam::doctor
