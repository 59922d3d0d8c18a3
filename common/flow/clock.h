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

inline TimeNs utc_now_ns() { return now_ns_of<std::chrono::system_clock>(); }
inline TimeNs monotonic_now_ns() { return now_ns_of<std::chrono::steady_clock>(); }

}  // namespace coslam
