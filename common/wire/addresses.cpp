// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/addresses.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <netinet/in.h>

#include <algorithm>
#include <array>

namespace coslam {

std::vector<std::string> local_addresses() {
  std::vector<std::string> addresses;
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) return addresses;
  for (const ifaddrs* i = list; i != nullptr; i = i->ifa_next) {
    if (i->ifa_addr == nullptr || i->ifa_addr->sa_family != AF_INET) continue;
    std::array<char, INET_ADDRSTRLEN> text{};
    inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(i->ifa_addr)->sin_addr, text.data(), text.size());
    addresses.emplace_back(text.data());
  }
  freeifaddrs(list);
  return addresses;
}

std::vector<std::string> addresses_used(const WireConfig& config) {
  if (!config.interfaces.empty()) return config.interfaces;
  std::vector<std::string> all = local_addresses();
  const auto is_loopback = [](const std::string& address) { return address.starts_with("127."); };
  if (!std::ranges::all_of(all, is_loopback)) std::erase_if(all, is_loopback);
  return all;
}

}  // namespace coslam
