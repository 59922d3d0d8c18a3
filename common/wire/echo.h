// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/base/time.h"
#include "common/wire/guard.h"
#include "common/wire/ipv4_endpoint.h"

// Whether datagrams reach a process, and come back: its transport answers, below the middleware, so that whoever asks
// need not join the domain. Question and answer have the same size, so that nothing is to be gained by asking in the
// name of somebody else. Where there is a key both are sealed as all else is.
namespace coslam {

constexpr std::size_t kEchoBytes = 128;
using EchoOctets = std::array<std::uint8_t, kEchoBytes>;

struct EchoRequest {
  std::uint64_t number = 0;       // comes back in the answer
  std::uint16_t answer_port = 0;  // port on the asking host; 0: where the question came from
};

struct EchoAnswer {
  std::uint64_t number = 0;
  TimeNs answered_ns = 0;  // UTC by the clock of the host that answers
  std::uint16_t protocol = 0;
  std::string name;  // name of the participant
};

EchoOctets encode(const EchoRequest& request);
EchoOctets encode(const EchoAnswer& answer);
// Decodes a request; empty for anything else.
std::optional<EchoRequest> decode_echo_request(std::span<const std::uint8_t> datagram);
std::optional<EchoAnswer> decode_echo_answer(std::span<const std::uint8_t> datagram);

// Answers for one participant. Thread-safe.
class EchoAnswerer {
 public:
  EchoAnswerer(const std::string& name, const std::optional<FleetKey>& key);
  ~EchoAnswerer();
  EchoAnswerer(const EchoAnswerer&) = delete;
  EchoAnswerer& operator=(const EchoAnswerer&) = delete;

  // Answers a question, unless there were too many in this second. False: it is something else.
  bool take(std::span<const std::uint8_t> datagram, const Ipv4Endpoint& from);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace coslam
