// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "common/base/time.h"
#include "common/model/session.h"

namespace coslam {

// When a replay begins to play, by the clock of its machine, from the server's words. What a word takes by both clocks
// is more than clocks differ by: a little more than nothing may all be the way, and what looks like a clock that is
// wrong may be a word that was lost and sent again, so that is believed when several say so. Pure. Thread-compatible.
class PlayStart {
 public:
  struct Known {
    TimeNs start_utc_ns = 0;   // clock of this machine
    double clock_ahead_s = 0;  // offset of this machine's clock to the server's, as far as known; negative: behind
  };

  // A new word of the server's in which play has been ordered. clock_ahead_s: the least that a word took.
  std::optional<Known> heard(const ServerStatus& status, double clock_ahead_s);

 private:
  int unusual_ = 0;
};

}  // namespace coslam
