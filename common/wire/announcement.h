// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/wire/ipv4_endpoint.h"
#include "common/wire/peer_paths.h"

namespace coslam {

// What a participant of DDS, of ours or not, says of itself to all again and again.
struct Announcement {
  ParticipantKey key{};
  std::array<std::uint8_t, 2> vendor{};
  std::string name;                     // empty: it says none
  std::vector<Ipv4Endpoint> endpoints;  // where it can be told of others
};

bool is_rtps(std::span<const std::uint8_t> datagram);

// Of a datagram. Empty for any other, and for nonsense; whatever it holds, nothing outside is read.
std::optional<Announcement> read_announcement(std::span<const std::uint8_t> datagram);

}  // namespace coslam
