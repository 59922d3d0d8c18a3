// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

#include "common/base/time.h"

namespace coslam {

template <class Clock>
TimeNs now_ns_of() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now().time_since_epoch()).count();
}

inline TimeNs monotonic_now_ns() { return now_ns_of<std::chrono::steady_clock>(); }
// UTC as this machine has it now. It may be set, and then jumps.
inline TimeNs time_of_day_ns() { return now_ns_of<std::chrono::system_clock>(); }

// UTC as this machine had it when it was first asked, and on from there without a jump: what stamps are made of.
TimeNs utc_now_ns();
// Sum of the steps by which the time of day was set since this process began to use the clock; 0 unless it jumped by
// more than 10 ms.
TimeNs clock_set_ns();

}  // namespace coslam
