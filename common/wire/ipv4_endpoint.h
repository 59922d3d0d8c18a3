// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstdint>

namespace coslam {

struct Ipv4Endpoint {
  std::uint32_t address = 0;  // in the host's byte order
  std::uint16_t port = 0;
  auto operator<=>(const Ipv4Endpoint&) const = default;
};

}  // namespace coslam
