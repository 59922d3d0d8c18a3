// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/flow/clock.h"

#include <cstdlib>

namespace coslam {
namespace {

// Time of day minus monotonic time. The two are not read at one instant: of three readings that took least.
TimeNs utc_minus_monotonic_ns() {
  TimeNs best_took_ns = 0, best_ns = 0;
  for (int i = 0; i < 3; ++i) {
    const TimeNs before_ns = monotonic_now_ns(), utc_ns = time_of_day_ns(), took_ns = monotonic_now_ns() - before_ns;
    if (i > 0 && took_ns >= best_took_ns) continue;
    best_took_ns = took_ns;
    best_ns = utc_ns - before_ns;
  }
  return best_ns;
}

TimeNs at_first_ns() {
  static const TimeNs first_ns = utc_minus_monotonic_ns();
  return first_ns;
}

}  // namespace

TimeNs utc_now_ns() { return at_first_ns() + monotonic_now_ns(); }

TimeNs clock_set_ns() {
  constexpr TimeNs kJump_ns = 10'000'000;
  const TimeNs first_ns = at_first_ns(), by_ns = utc_minus_monotonic_ns() - first_ns;
  return std::abs(by_ns) > kJump_ns ? by_ns : 0;
}

}  // namespace coslam
