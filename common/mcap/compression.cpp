// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/mcap/compression.h"

#include <zstd.h>

#include "common/base/check.h"

namespace coslam::mcap {

std::string zstd_compressed(std::string_view octets) {
  constexpr int kLevel = 1;  // 3 and more take twice the time for some percent
  std::string out(ZSTD_compressBound(octets.size()), '\0');
  const std::size_t size = ZSTD_compress(out.data(), out.size(), octets.data(), octets.size(), kLevel);
  COSLAM_CHECK(ZSTD_isError(size) == 0, "compression has all the room that it may need");
  out.resize(size);
  return out;
}

std::optional<std::string> zstd_decompressed(std::string_view octets, std::uint64_t size) {
  const unsigned long long told = ZSTD_getFrameContentSize(octets.data(), octets.size());
  if (told != ZSTD_CONTENTSIZE_UNKNOWN && told != size) return std::nullopt;
  std::string out(size, '\0');
  const std::size_t got = ZSTD_decompress(out.data(), out.size(), octets.data(), octets.size());
  if (ZSTD_isError(got) != 0 || got != size) return std::nullopt;
  return out;
}

}  // namespace coslam::mcap
