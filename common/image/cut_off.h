// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace coslam {

// Whether a JPEG or PNG lacks its end. libjpeg fills the missing rest with grey and reports success.
inline bool is_cut_off(std::span<const std::uint8_t> octets) {
  const std::string_view all(reinterpret_cast<const char*>(octets.data()), octets.size());
  const auto begins_but_does_not_end = [&](std::string_view start, std::string_view end) {
    constexpr std::size_t kPadding = 1024;  // some cameras pad their files
    return all.starts_with(start) && all.substr(all.size() - std::min(all.size(), kPadding)).find(end) == all.npos;
  };
  return begins_but_does_not_end("\xff\xd8", "\xff\xd9") || begins_but_does_not_end("\x89PNG", "IEND");
}

}  // namespace coslam
