// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "common/base/time.h"

namespace coslam {

// Decides when recordings begin to play on a server that waits for nobody in particular: together, when no agent has
// joined for a while. Agents that join later join in what is played by then. Pure: time is an argument.
// Thread-compatible.
class PlayOrder {
 public:
  static constexpr double kGather_s = 3;

  void joined(TimeNs now_ns);
  // Notes that a frame of a recording came, so that its time runs.
  void plays() { plays_ = true; }
  // True once, when the start is to be ordered.
  bool due(TimeNs now_ns);
  bool ordered() const { return ordered_ns_.has_value(); }

 private:
  std::optional<TimeNs> newest_ns_;  // newest agent's joining
  std::optional<TimeNs> ordered_ns_;
  bool plays_ = false;
};

}  // namespace coslam
