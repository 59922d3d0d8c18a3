// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>

namespace coslam {

// Capture time in nanoseconds: UTC for live sources, played time (0 at the start) for files.
using TimeNs = std::int64_t;

// Monotonic time of this process, for timeouts. Pure code takes it as an argument.
using Instant = std::chrono::steady_clock::time_point;

// A part of a played time: from_s <= t < to_s.
struct TimeSpan {
  double from_s = 0, to_s = 0;
};

constexpr double to_seconds(TimeNs t_ns) { return static_cast<double>(t_ns) * 1e-9; }
inline std::chrono::milliseconds to_milliseconds(double seconds) {
  return std::chrono::milliseconds(std::lround(1000 * seconds));
}
inline TimeNs to_ns(double seconds) { return static_cast<TimeNs>(std::llround(seconds * 1e9)); }

}  // namespace coslam
