// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace coslam::test {

inline void append(std::vector<std::uint8_t>& to, const std::vector<std::uint8_t>& more) {
  to.insert(to.end(), more.begin(), more.end());
}

// As Fast DDS sends it: a destination, a time stamp, then the data with inline QoS.
inline std::vector<std::uint8_t> announcement() {
  std::vector<std::uint8_t> data{0, 0, 16, 0, 0, 1, 0, 0xc7, 0, 1, 0, 0xc2, 0, 0, 0, 0, 1, 0, 0, 0};
  append(data, {0x70, 0, 4, 0, 9, 9, 9, 9, 1, 0, 0, 0});                         // inline QoS
  append(data, {0, 3, 0, 0});                                                    // parameters, little-endian
  append(data, {0x62, 0, 12, 0, 5, 0, 0, 0, 'l', 'e', 'f', 't', 0, 0, 0, 0});    // name
  append(data, {0x32, 0, 24, 0, 1, 0, 0, 0, 0xc8, 0x23, 0, 0});                  // UDP v4, port 9160
  append(data, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 10, 88, 0, 1, 1, 0, 0, 0});  // its address; the end
  std::vector<std::uint8_t> out{'R', 'T', 'P', 'S', 2, 3, 1, 15, 1, 15, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
  append(out, {0x09, 1, 8, 0, 1, 1, 1, 1, 2, 2, 2, 2});
  append(out, {0x15, 7, static_cast<std::uint8_t>(data.size()), 0});
  append(out, data);
  return out;
}

}  // namespace coslam::test
