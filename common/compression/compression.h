// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <istream>
#include <optional>
#include <string>
#include <string_view>

// Compression of recordings. What is decompressed grows as it comes out, so that a size that lies takes no memory.
namespace coslam {

std::string zstd_compressed(std::string_view octets);

// Each is empty when the octets are not what was compressed, or not of that size.
std::optional<std::string> zstd_decompressed(std::string_view octets, std::uint64_t size);
std::optional<std::string> lz4_decompressed(std::string_view octets, std::uint64_t size);  // LZ4's frame format
std::optional<std::string> bzip2_decompressed(std::string_view octets, std::uint64_t size);

bool is_zstd(std::string_view octets);  // by the first four octets
// The same of a size that is not known; empty also where there would be more than `most` octets.
std::optional<std::string> zstd_decompressed_at_most(std::string_view octets, std::uint64_t most);

// Decompresses a stream in pieces to `write`. False: it is damaged or cut off; what came out before was written.
bool zstd_decompress(std::istream& stream, const std::function<void(std::string_view)>& write);

}  // namespace coslam
