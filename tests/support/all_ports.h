// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>
#include <vector>

namespace coslam::test {

// Holds all UDP ports of a domain that a participant on this host could listen on.
class AllPorts {
 public:
  explicit AllPorts(int domain) {
    for (int port = 7400 + 250 * domain; port < 7400 + 250 * (domain + 1); ++port) {
      sockets_.push_back(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
      sockaddr_in any{};
      any.sin_family = AF_INET;
      any.sin_port = htons(static_cast<std::uint16_t>(port));
      (void)bind(sockets_.back(), reinterpret_cast<const sockaddr*>(&any), sizeof(any));
    }
  }
  ~AllPorts() {
    for (const int s : sockets_) close(s);
  }
  AllPorts(const AllPorts&) = delete;
  AllPorts& operator=(const AllPorts&) = delete;

 private:
  std::vector<int> sockets_;
};

}  // namespace coslam::test
