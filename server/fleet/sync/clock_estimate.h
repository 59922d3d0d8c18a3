// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>

#include "common/base/time.h"
#include "common/model/session.h"

namespace coslam {

// Offset and drift of an agent's clock from the server's by such exchanges: each tells the offset give or take half of
// its time under way, so that the fast ones of the last half minute decide. A clock that was set begins anew.
class ClockEstimate {
 public:
  // Nonsense (an answer before the question) is left out.
  void add(const ClockExchange& stamps);
  // The agent's clock minus the server's at a time of the server; empty before three exchanges.
  std::optional<double> offset_s(TimeNs server_ns) const;

 private:
  struct Sample {
    double at_s = 0, offset_s = 0, round_trip_s = 0;
  };
  struct Line {
    double offset_s = 0, drift = 0;  // at origin_ns_ + at_s
    double at_s = 0;
  };
  Line fit() const;
  std::optional<double> predicted_s(double at_s) const;

  TimeNs origin_ns_ = 0;       // server time that `at` seconds count from
  TimeNs offset_zero_ns_ = 0;  // zero of the offsets: doubles cannot hold nanoseconds of years
  std::deque<Sample> samples_;
  int strays_ = 0;  // in succession
};

}  // namespace coslam
