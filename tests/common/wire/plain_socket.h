// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/eventually.h"

namespace coslam::test {

using Octets = std::vector<std::uint8_t>;

// A plain socket on the loopback device.
class Socket {
 public:
  // Listens on a port, or on any.
  explicit Socket(std::uint16_t port = 0) {
    const sockaddr_in here = address(port);
    if (bind(socket_, reinterpret_cast<const sockaddr*>(&here), sizeof(here)) != 0) {
      throw std::runtime_error("port " + std::to_string(port) + " is in use");
    }
    const timeval most{kDeadline.count(), 0};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &most, sizeof(most));
  }
  ~Socket() { close(socket_); }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  void send(const Octets& octets, std::uint16_t port) const {
    const sockaddr_in there = address(port);
    sendto(socket_, octets.data(), octets.size(), 0, reinterpret_cast<const sockaddr*>(&there), sizeof(there));
  }
  Octets receive() const {
    Octets octets(65536);
    octets.resize(static_cast<std::size_t>(std::max<ssize_t>(0, recv(socket_, octets.data(), octets.size(), 0))));
    return octets;
  }

 private:
  static sockaddr_in address(std::uint16_t port) {
    sockaddr_in out{};
    out.sin_family = AF_INET;
    out.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    out.sin_port = htons(port);
    return out;
  }

  int socket_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
};

}  // namespace coslam::test
