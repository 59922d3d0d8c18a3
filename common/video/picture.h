// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace coslam {

// A decoded picture in the memory of its decoder, which keeps it until it is asked for the next.
struct Picture {
  int width_px = 0, height_px = 0;
  int channels = 1;          // 1: grey; 3: blue, green, red
  int octets_per_value = 1;  // 2: in the machine's own order
  std::size_t octets_per_row = 0;
  const std::uint8_t* pixels = nullptr;  // null: there is no picture

  bool empty() const { return pixels == nullptr; }
};

}  // namespace coslam
