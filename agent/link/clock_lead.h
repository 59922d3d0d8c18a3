// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>

namespace coslam {

// Lead of this machine's clock over the server's: the least time that a new status seems to have been under way.
// Thread-compatible.
class ClockLead {
 public:
  // Takes the time between the writing of a status by the server's clock and its arrival by this one. first: of this
  // server, and may have been kept for late joiners, unless it was written when the server started.
  void note(double took_s, bool first, bool at_start) {
    // Nothing takes less than no time, and none is kept for three seconds.
    const bool is_new = !first || took_s < 0 || took_s > 3 || at_start;
    if (first) least_took_s_.reset();
    if (is_new) least_took_s_ = std::min(least_took_s_.value_or(took_s), took_s);
  }
  // Seconds ahead; empty before the first new status.
  std::optional<double> seconds() const { return least_took_s_; }

 private:
  std::optional<double> least_took_s_;
};

}  // namespace coslam
