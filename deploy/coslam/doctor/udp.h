// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/wire/ipv4_endpoint.h"

namespace coslam::doctor {

std::string text_of(std::uint32_t address);
std::optional<std::uint32_t> address_of(const std::string& text);

// A UDP socket that never waits.
class Udp {
 public:
  enum class Share { kNo, kYes };  // the port with others that share it

  Udp();
  ~Udp();
  Udp(Udp&& other) noexcept;
  Udp& operator=(Udp&& other) noexcept;
  Udp(const Udp&) = delete;
  Udp& operator=(const Udp&) = delete;

  bool bind(int port, Share share = Share::kNo);
  bool join(const std::string& group, unsigned interface);
  bool send_by(unsigned interface);  // to groups, from then on

  // Sends a datagram; false: the system refused, with the reason in errno.
  bool send(std::span<const std::uint8_t> datagram, const Ipv4Endpoint& to) const;

  struct Received {
    std::vector<std::uint8_t> octets;
    Ipv4Endpoint from;
    unsigned interface = 0;  // on which it came
  };
  std::optional<Received> receive() const;

  // Error of the network for a datagram that did not arrive.
  struct Undelivered {
    Ipv4Endpoint to;
    int error = 0;  // an errno
  };
  std::optional<Undelivered> undelivered() const;

  int handle() const { return socket_; }

 private:
  int socket_ = -1;
};

}  // namespace coslam::doctor
