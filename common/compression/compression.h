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

// Decompresses octets of a known size; empty when they are damaged or yield another size.
std::optional<std::string> zstd_decompressed(std::string_view octets, std::uint64_t size);
std::optional<std::string> lz4_decompressed(std::string_view octets, std::uint64_t size);  // LZ4's frame format
std::optional<std::string> bzip2_decompressed(std::string_view octets, std::uint64_t size);

bool is_zstd(std::string_view octets);  // tells by the first four octets
// Decompresses octets of unknown size; empty also when there would be more than `most` octets.
std::optional<std::string> zstd_decompressed_at_most(std::string_view octets, std::uint64_t most);

// Decompresses a stream in pieces to `write`. False: it is damaged or cut off; what came out before was written.
bool zstd_decompress(std::istream& stream, const std::function<void(std::string_view)>& write);

}  // namespace coslam
