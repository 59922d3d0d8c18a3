// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/peer_names.h"

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <memory>
#include <thread>

#include "common/base/error.h"
#include "common/base/log.h"
#include "common/base/words.h"

namespace coslam {
namespace {

bool is_address(int family, const std::string& text) {
  in6_addr address{};
  return inet_pton(family, text.c_str(), &address) == 1;
}

using AddressList = std::unique_ptr<addrinfo, decltype([](addrinfo* list) { freeaddrinfo(list); })>;

// Of a name; `error` is that of getaddrinfo().
AddressList look_up(const std::string& name, int family, int* error) {
  addrinfo wanted{}, *list = nullptr;
  wanted.ai_family = family;
  wanted.ai_socktype = SOCK_DGRAM;
  *error = getaddrinfo(name.c_str(), nullptr, &wanted, &list);
  return AddressList(*error == 0 ? list : nullptr);
}

// What cannot be a peer, though it may look like one to the system.
void require_peer(const std::string& peer) {
  const auto fail = [&](const std::string& why) { throw UserError("peer '" + peer + "' " + why); };
  if (is_address(AF_INET6, peer)) fail("is an IPv6 address: the fleet speaks IPv4");
  if (peer.find_first_of(":/") != peer.npos)
    fail("is more than a name or an IPv4 address: leave out the port and the rest");
  in_addr address{};
  if (inet_aton(peer.c_str(), &address) == 0) return;  // a name
  if (!is_address(AF_INET, peer)) fail("is no whole IPv4 address: four numbers are expected, as in 192.168.1.20");
  const std::uint32_t first = ntohl(address.s_addr) >> 24U;
  constexpr std::uint32_t kMulticast = 224;  // and what follows, up to the broadcast
  if (first == 0 || first >= kMulticast) fail("is the address of no single machine");
}

}  // namespace

std::vector<std::string> addresses_of_peer(const std::string& peer) {
  require_peer(peer);
  if (is_address(AF_INET, peer)) return {peer};
  int error = 0, error_of_ipv6 = 0;
  const AddressList list = look_up(peer, AF_INET, &error);
  if (error != 0 && look_up(peer, AF_INET6, &error_of_ipv6))
    throw UserError("peer '" + peer + "' has only IPv6 addresses: the fleet speaks IPv4");
  if (error != 0) {
    throw UserError("peer '" + peer + "' is no IPv4 address and no name of one: " + gai_strerror(error));
  }
  std::vector<std::string> out;
  for (const addrinfo* i = list.get(); i != nullptr; i = i->ai_next) {
    std::array<char, INET_ADDRSTRLEN> text{};
    inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(i->ai_addr)->sin_addr, text.data(), text.size());
    out.emplace_back(text.data());
  }
  return out;
}

std::vector<std::string> unknown_peers(const std::vector<std::string>& peers) {
  std::vector<std::string> out;
  for (const std::string& peer : peers) {
    require_peer(peer);
    int error = 0;
    if (!is_address(AF_INET, peer) && !look_up(peer, AF_INET, &error) && !look_up(peer, AF_INET6, &error)) {
      out.push_back(peer);
    }
  }
  return out;
}

void await_names(std::vector<std::string>* peers, const std::function<bool()>& wait,
                 const std::function<std::vector<std::string>(const std::vector<std::string>&)>& unknown) {
  std::vector<std::string> missing = unknown(*peers);
  if (missing.empty()) return;
  const auto named = [&] { return (missing.size() == 1 ? "peer " : "peers ") + joined(missing); };
  log_info("no address is known of the " + named() + " yet: waiting for it");
  while (!missing.empty() && wait()) missing = unknown(*peers);
  if (missing.empty()) return;
  log_warn("no address is known of the " + named() +
           ": going on without, which does where multicast passes; a name has to resolve (`getent hosts NAME`), an "
           "IPv4 address always works");
  std::erase_if(*peers, [&](const std::string& peer) { return std::ranges::count(missing, peer) > 0; });
}

std::function<bool()> while_starting(std::function<bool()> stops) {
  constexpr std::chrono::seconds kMost{10};
  constexpr std::chrono::milliseconds kMoment{250};
  const auto until = std::chrono::steady_clock::now() + kMost;
  return [=, stops = std::move(stops)] {
    std::this_thread::sleep_for(kMoment);
    return !stops() && std::chrono::steady_clock::now() < until;
  };
}

}  // namespace coslam
