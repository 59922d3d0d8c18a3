// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/doctor/udp.h"

#include <arpa/inet.h>
#include <linux/errqueue.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

namespace coslam::doctor {
namespace {

sockaddr_in in_system(const Ipv4Endpoint& endpoint) {
  sockaddr_in out{};
  out.sin_family = AF_INET;
  out.sin_addr.s_addr = htonl(endpoint.address);
  out.sin_port = htons(endpoint.port);
  return out;
}

Ipv4Endpoint from_system(const sockaddr_in& endpoint) {
  return {ntohl(endpoint.sin_addr.s_addr), ntohs(endpoint.sin_port)};
}

// Room for what the system tells beside a datagram.
struct Message {
  sockaddr_in peer{};
  std::array<char, 256> beside{};
  iovec part{};
  msghdr head{};

  explicit Message(std::vector<std::uint8_t>& octets) {
    part = {octets.data(), octets.size()};
    head.msg_name = &peer;
    head.msg_namelen = sizeof peer;
    head.msg_iov = &part;
    head.msg_iovlen = 1;
    head.msg_control = beside.data();
    head.msg_controllen = beside.size();
  }

  template <class Value>
  std::optional<Value> control_data(int type) {
    for (cmsghdr* c = CMSG_FIRSTHDR(&head); c != nullptr; c = CMSG_NXTHDR(&head, c)) {
      if (c->cmsg_level != IPPROTO_IP || c->cmsg_type != type) continue;
      Value value{};
      std::memcpy(&value, CMSG_DATA(c), sizeof value);
      return value;
    }
    return std::nullopt;
  }
};

constexpr std::size_t kMostOctets = 65536;

}  // namespace

std::string text_of(std::uint32_t address) {
  const in_addr binary{htonl(address)};
  std::array<char, INET_ADDRSTRLEN> text{};
  inet_ntop(AF_INET, &binary, text.data(), text.size());
  return text.data();
}

std::optional<std::uint32_t> address_of(const std::string& text) {
  in_addr binary{};
  if (inet_pton(AF_INET, text.c_str(), &binary) != 1) return std::nullopt;
  return ntohl(binary.s_addr);
}

Udp::Udp() : socket_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)) {
  const int yes = 1;
  setsockopt(socket_, IPPROTO_IP, IP_PKTINFO, &yes, sizeof yes);
  setsockopt(socket_, IPPROTO_IP, IP_RECVERR, &yes, sizeof yes);
}

Udp::~Udp() {
  if (socket_ >= 0) close(socket_);
}

Udp::Udp(Udp&& other) noexcept : socket_(std::exchange(other.socket_, -1)) {}

Udp& Udp::operator=(Udp&& other) noexcept {
  std::swap(socket_, other.socket_);
  return *this;
}

bool Udp::bind(int port, Share share) {
  const int yes = 1;
  if (share == Share::kYes) setsockopt(socket_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  const sockaddr_in address = in_system({0, static_cast<std::uint16_t>(port)});
  return ::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
}

bool Udp::join(const std::string& group, unsigned interface) {
  ip_mreqn request{};
  inet_pton(AF_INET, group.c_str(), &request.imr_multiaddr);
  request.imr_ifindex = static_cast<int>(interface);
  return setsockopt(socket_, IPPROTO_IP, IP_ADD_MEMBERSHIP, &request, sizeof request) == 0;
}

bool Udp::send_by(unsigned interface) {
  ip_mreqn request{};
  request.imr_ifindex = static_cast<int>(interface);
  return setsockopt(socket_, IPPROTO_IP, IP_MULTICAST_IF, &request, sizeof request) == 0;
}

bool Udp::send(std::span<const std::uint8_t> datagram, const Ipv4Endpoint& to) const {
  const sockaddr_in address = in_system(to);
  const auto try_it = [&] {
    return sendto(socket_, datagram.data(), datagram.size(), 0, reinterpret_cast<const sockaddr*>(&address),
                  sizeof address) >= 0;
  };
  if (try_it()) return true;
  return try_it();  // the first error may be that of an earlier datagram
}

std::optional<Udp::Received> Udp::receive() const {
  Received out{std::vector<std::uint8_t>(kMostOctets), {}, 0};
  Message message(out.octets);
  ssize_t size = -1;
  // What became of earlier datagrams is told by undelivered().
  for (int i = 0; i < 8 && (size = recvmsg(socket_, &message.head, 0)) < 0; ++i) {
    if (errno == EAGAIN) return std::nullopt;
  }
  if (size < 0) return std::nullopt;
  out.octets.resize(static_cast<std::size_t>(size));
  out.from = from_system(message.peer);
  if (const auto info = message.control_data<in_pktinfo>(IP_PKTINFO))
    out.interface = static_cast<unsigned>(info->ipi_ifindex);
  return out;
}

std::optional<Udp::Undelivered> Udp::undelivered() const {
  std::vector<std::uint8_t> octets(kMostOctets);
  Message message(octets);
  if (recvmsg(socket_, &message.head, MSG_ERRQUEUE) < 0) return std::nullopt;
  const auto error = message.control_data<sock_extended_err>(IP_RECVERR);
  return Undelivered{from_system(message.peer), error ? static_cast<int>(error->ee_errno) : 0};
}

}  // namespace coslam::doctor
