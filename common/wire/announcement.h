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

// Announcement that any DDS participant, also of other products, repeats to all.
struct Announcement {
  ParticipantKey key{};
  std::array<std::uint8_t, 2> vendor{};
  std::string name;                     // empty: it says none
  std::vector<Ipv4Endpoint> endpoints;  // addresses where it accepts announcements of others
};

bool is_rtps(std::span<const std::uint8_t> datagram);

// Reads a datagram. Empty when it is no announcement or is malformed; never reads outside of the datagram.
std::optional<Announcement> read_announcement(std::span<const std::uint8_t> datagram);

}  // namespace coslam
