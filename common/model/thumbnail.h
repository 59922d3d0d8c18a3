// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "common/base/ids.h"
#include "common/base/time.h"

namespace coslam {

inline constexpr std::size_t kMostThumbnailBytes = 5120;

// Request for an agent's image, because somebody at the live page wants to see it.
struct ThumbnailRequest {
  std::string agent;
  RunId agent_run, server_run;
};

// The answer: a small grey image.
struct Thumbnail {
  std::string agent;
  RunId agent_run;
  TimeNs capture_ns = 0;
  std::vector<std::uint8_t> jpeg;  // empty: this agent gives none, by its configuration
};

}  // namespace coslam
