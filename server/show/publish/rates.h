// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <map>
#include <string>

#include "server/show/publish/snapshot.h"

namespace coslam {

// Recent rates per second, from the running totals in the states.
class Rates {
 public:
  struct Agent {
    double bytes_up_per_s = 0, bytes_down_per_s = 0;  // per second of the server's clock
    double lost_percent = 0;  // share of the frames sent by an agent that became part of no frame set
  };

  void see(const PublicState& state);

  double ms_per_set() const { return ms_per_set_; }
  Agent rate_of(const std::string& agent) const;

 private:
  struct Sums {
    TimeNs wall_ns = 0;
    RunId run;
    std::uint64_t bytes_up = 0, bytes_down = 0;
    double due = 0, used = 0;  // frames
  };
  struct SetSums {
    TimeNs wall_ns = 0;
    double ms = 0, sets = 0;
  };
  std::map<std::string, std::deque<Sums>> agents_;
  std::deque<SetSums> sets_;
  double ms_per_set_ = 0;
};

}  // namespace coslam
