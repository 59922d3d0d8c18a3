// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "common/base/time.h"

namespace coslam {

// When recordings begin to play on a server that waits for nobody in particular: together, when nobody has joined for a
// while. Who joins later joins in what is played by then. Pure: time is an argument. Thread-compatible.
class PlayOrder {
 public:
  static constexpr double kGather_s = 3;

  void joined(TimeNs now_ns);
  // A frame of a recording came: its time runs.
  void plays() { plays_ = true; }
  // Once, when it is to be ordered.
  bool due(TimeNs now_ns);
  bool ordered() const { return ordered_ns_.has_value(); }

 private:
  std::optional<TimeNs> newest_ns_;  // who joined
  std::optional<TimeNs> ordered_ns_;
  bool plays_ = false;
};

}  // namespace coslam
