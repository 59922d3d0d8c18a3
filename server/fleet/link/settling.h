// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

#include "common/base/ids.h"
#include "common/base/log.h"
#include "common/base/time.h"
#include "common/wire/wire_config.h"

namespace coslam {

// Start of a server in its domain: it says nothing for a while, to hear of one that was there before. Time is an
// argument. Thread-compatible.
class Settling {
 public:
  Settling(const WireConfig& config, RunId run, Instant opened_at);

  bool settled() const { return state_ == State::kSettled; }
  // Settles when the time has come; true when this call did. alone: no other server is known.
  bool settle(bool alone, Instant now);
  // Takes note that another server is at work. The result is true when it was there before, so that this one must end.
  bool yields_to_rival();

 private:
  enum class State { kSilent, kSettled, kYielded };

  const Instant opened_at_;
  const std::chrono::milliseconds silence_alone_, silence_;
  State state_ = State::kSilent;
  LogLimiter rival_log_;
};

}  // namespace coslam
