// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace coslam::mcap {

std::string zstd_compressed(std::string_view octets);
// Empty when it is not what was compressed, or not of that size.
std::optional<std::string> zstd_decompressed(std::string_view octets, std::uint64_t size);

}  // namespace coslam::mcap
