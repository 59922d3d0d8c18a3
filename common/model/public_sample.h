// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/base/time.h"

namespace coslam {

// A message for the public in its public form, on its way to whoever hands it on.
struct PublicSample {
  std::string topic;  // "/coslam/map/points"
  std::string type;   // ROS 2 type, or "json"
  TimeNs t_ns = 0;    // capture time
  std::vector<std::uint8_t> octets;
};

inline constexpr const char* kJsonType = "json";

}  // namespace coslam
