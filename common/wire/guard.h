// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/wire/counters.h"

// A seal around each datagram, so that one of a stranger is refused before the middleware reads it:
//
//   sender, 8 octets | payload | counter, 8 octets | tag, 16 octets
//
// The sender is drawn for each Sealer, the counter goes up with each datagram, and the tag is the first half of the
// HMAC-SHA256 of all that stands before it. The sender stands in front, and never starts like RTPS: who has no key
// takes a sealed datagram for no RTPS at all. Integers are little-endian.
namespace coslam {

constexpr std::size_t kSealBytes = 32;

using FleetKey = std::array<std::uint8_t, 32>;

// The key of a DDS domain; domains differ. `secret` is what the fleet shares.
FleetKey fleet_key(std::string_view secret, int domain);
// The secret is the content of the file, without the end of line at its end: 16 to 4096 bytes, for its owner's eyes
// only. Throws UserError.
FleetKey load_fleet_key(const std::string& file, int domain);

// Seals what one participant sends. Thread-safe.
class Sealer {
 public:
  explicit Sealer(const FleetKey& key);
  ~Sealer();
  Sealer(const Sealer&) = delete;
  Sealer& operator=(const Sealer&) = delete;

  // Replaces what `sealed` holds; the memory is used again.
  void seal(std::span<const std::uint8_t> payload, std::vector<std::uint8_t>& sealed);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

struct Opened {
  std::optional<Rejection> refused;       // kUnauthentic or kReplayed
  std::span<const std::uint8_t> payload;  // within what was opened; empty when refused
};

// Opens what one participant receives, each datagram once. Counters may come out of order within kWindow; older ones
// count as seen. Only datagrams with a right tag leave a trace. Thread-safe.
class Opener {
 public:
  static constexpr std::uint64_t kWindow = 4096;     // newest counters of a sender
  static constexpr std::size_t kMostSenders = 1024;  // above it, the one unheard for longest is forgotten

  explicit Opener(const FleetKey& key);
  ~Opener();
  Opener(const Opener&) = delete;
  Opener& operator=(const Opener&) = delete;

  Opened open(std::span<const std::uint8_t> sealed);
  std::size_t senders() const;  // remembered now

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace coslam
