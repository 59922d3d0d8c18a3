// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>
#include <stdexcept>

namespace coslam::test {

// A DDS domain that no other test on this machine uses while this object lives: tests run in parallel, and under
// several users. A bound port serves as the lock, since the kernel gives it back however the process ends. Domains stay
// below 100, whose UDP ports lie under the range from which the kernel hands out ports.
class TestDomain {
 public:
  TestDomain() {
    for (int i = 0; i < kCount; ++i) {
      number_ = kFirst + static_cast<int>((getpid() + i) % kCount);
      if (lock()) return;
    }
    throw std::runtime_error("all test domains are in use");
  }
  ~TestDomain() { close(socket_); }
  TestDomain(const TestDomain&) = delete;
  TestDomain& operator=(const TestDomain&) = delete;

  int number() const { return number_; }

 private:
  static constexpr int kFirst = 10;
  static constexpr int kCount = 90;

  bool lock() {
    socket_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(static_cast<std::uint16_t>(7000 + number_));
    if (bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0) return true;
    close(socket_);
    return false;
  }

  int number_ = 0;
  int socket_ = -1;
};

}  // namespace coslam::test
