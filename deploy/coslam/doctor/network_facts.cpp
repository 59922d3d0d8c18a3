// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <sstream>

#include "common/base/text.h"
#include "common/wire/ports.h"
#include "deploy/coslam/doctor/network.h"
#include "deploy/coslam/doctor/udp.h"

namespace coslam::doctor {
namespace {

using AddressList = std::unique_ptr<ifaddrs, decltype([](ifaddrs* list) { freeifaddrs(list); })>;

int mtu_of(const std::string& name) {
  const int s = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  ifreq request{};
  std::strncpy(request.ifr_name, name.c_str(), IFNAMSIZ - 1);
  const bool known = ioctl(s, SIOCGIFMTU, &request) == 0;
  close(s);
  return known ? request.ifr_mtu : 0;
}

void note(Interface& interface, const ifaddrs& entry) {
  interface.name = entry.ifa_name;
  interface.up = (entry.ifa_flags & IFF_UP) != 0;
  interface.carrier = (entry.ifa_flags & IFF_RUNNING) != 0;
  interface.loopback = (entry.ifa_flags & IFF_LOOPBACK) != 0;
  interface.multicast = (entry.ifa_flags & IFF_MULTICAST) != 0;
  if (entry.ifa_addr == nullptr || entry.ifa_addr->sa_family != AF_INET) return;
  std::array<char, INET_ADDRSTRLEN> text{};
  inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(entry.ifa_addr)->sin_addr, text.data(), text.size());
  interface.addresses.emplace_back(text.data());
}

// The inodes of UDP sockets, by their port.
std::map<int, std::string> udp_sockets() {
  std::map<int, std::string> by_port;
  std::ifstream table("/proc/net/udp");
  std::string line;
  std::getline(table, line);
  while (std::getline(table, line)) {
    std::istringstream words(line);
    std::string number, local, remote, state, queues, timer, retries, uid, timeout, inode;
    words >> number >> local >> remote >> state >> queues >> timer >> retries >> uid >> timeout >> inode;
    const auto colon = local.find(':');
    if (colon != std::string::npos) by_port[std::stoi(local.substr(colon + 1), nullptr, 16)] = inode;
  }
  return by_port;
}

// Programs by the inodes of the sockets that they have, as far as this user may see.
std::map<std::string, HeldPort> programs_by_socket() {
  std::map<std::string, HeldPort> out;
  std::error_code ignored;
  for (const auto& process : std::filesystem::directory_iterator("/proc", ignored)) {
    const auto pid = parse_integer(process.path().filename().string());
    if (!pid) continue;
    std::string name;
    std::getline(std::ifstream(process.path() / "comm"), name);
    for (const auto& file : std::filesystem::directory_iterator(process.path() / "fd", ignored)) {
      const std::string target = std::filesystem::read_symlink(file.path(), ignored).string();
      if (target.starts_with("socket:[")) out[target.substr(8, target.size() - 9)] = {0, name, static_cast<int>(*pid)};
    }
  }
  return out;
}

}  // namespace

std::vector<Interface> look_at_interfaces() {
  ifaddrs* raw = nullptr;
  if (getifaddrs(&raw) != 0) return {};
  const AddressList list(raw);
  std::vector<Interface> out;
  for (const ifaddrs* i = list.get(); i != nullptr; i = i->ifa_next) {
    auto at = std::ranges::find(out, std::string(i->ifa_name), &Interface::name);
    if (at == out.end()) at = out.insert(out.end(), Interface());
    note(*at, *i);
  }
  for (Interface& i : out) {
    i.index = if_nametoindex(i.name.c_str());
    i.mtu = mtu_of(i.name);
  }
  return out;
}

PortFacts look_at_ports(int domain) {
  PortFacts facts;
  facts.domain = domain;
  facts.multicast_bindable = Udp().bind(multicast_port(domain), Udp::Share::kYes);
  const std::map<int, std::string> sockets = udp_sockets();
  std::map<std::string, HeldPort> programs;
  for (int participant = 0; participant < kMostPerHost; ++participant) {
    auto socket = sockets.find(unicast_port(domain, participant));
    if (socket == sockets.end()) socket = sockets.find(unicast_port(domain, participant) + 1);
    if (socket == sockets.end()) continue;
    if (programs.empty()) programs = programs_by_socket();
    HeldPort held = programs[socket->second];
    held.participant = participant;
    facts.held.push_back(held);
  }
  return facts;
}

}  // namespace coslam::doctor
