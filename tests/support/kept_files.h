// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include "common/compression/compression.h"

namespace coslam::test {

// Unpacks a file of tests/data, which an earlier version wrote.
inline void unpack_kept(const std::string& name, const std::filesystem::path& to) {
  constexpr std::size_t kMost = 4U << 20U;
  std::ifstream packed(std::filesystem::path(TEST_DATA) / (name + ".zst"), std::ios::binary);
  const std::string octets{std::istreambuf_iterator<char>(packed), {}};
  const auto plain = zstd_decompressed_at_most(octets, kMost);
  if (!plain) throw std::runtime_error(name + " cannot be read");
  std::ofstream(to, std::ios::binary) << *plain;
}

}  // namespace coslam::test
