// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/link/settling.h"

namespace coslam {

// That there is another server is known soon; what it says, and whether it just starts too, may take longer. The time
// differs between servers that start together, so that one of them speaks first.
Settling::Settling(const WireConfig& config, RunId run, Instant opened_at)
    : opened_at_(opened_at),
      silence_alone_(to_milliseconds(1.2 * config.announce_s)),
      silence_(to_milliseconds(5 * config.announce_s) + std::chrono::milliseconds(run.value % 1024)) {}

bool Settling::settle(bool alone, Instant now) {
  if (state_ != State::kSilent || now - opened_at_ < (alone ? silence_alone_ : silence_)) return false;
  state_ = State::kSettled;
  return true;
}

bool Settling::yields_to_rival() {
  if (state_ == State::kSilent) state_ = State::kYielded;
  if (settled() && rival_log_.pass()) {
    log_error("another map server is at work in this DDS domain: agents follow the newer one; stop one of them");
  }
  return !settled();
}

}  // namespace coslam
