// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>

#include "common/base/time.h"

namespace coslam {

// Decides which frames a live agent sends, from the time that messages wait on the link. On one that cannot carry all,
// they come ever later, since what waits for it heaps up: then only every second frame goes, every third and so on,
// down to ten a second. Where far too much waits, ten at once, after a pause in which that gets through; and ten at
// first. When messages come soon, more are tried: all at once while nothing came late, then after a while that doubles
// with each try that fails; a try is given up at the first sign. What the server itself takes, or waits for others,
// does not count. Pure: time is an argument. Thread-compatible.
class SendRate {
 public:
  explicit SendRate(double rate_hz);

  // Whether the frame of this capture time is to be sent; asked once a frame. Agents that send one in so many send
  // those of the same instants, as far as their clocks agree: what several cameras see at once is worth most.
  bool due(TimeNs capture_ns);
  // A message of the server. uplink_wait_s: how much longer than at best the newest frame took, as the server says;
  // downlink_s: how long the message took, give or take what the clocks differ by. full: no room is left over.
  void heard(double uplink_wait_s, double downlink_s, bool full, Instant now);
  // Tells the time once a frame, while the server lives: hearing nothing is as bad as hearing late.
  void tick(Instant now);

  // Number of frames of which one is sent.
  int one_in() const { return one_in_; }
  // The link carries less than everything, as far as is known: what is not urgent waits.
  bool narrow() const { return one_in_ > 1; }

 private:
  void waited(double wait_s, bool full, Instant now);
  void send_fewer(double wait_s, Instant now);
  bool trying(Instant now) const;

  const double rate_hz_;
  const int most_;
  int one_in_, before_try_ = 1, passed_ = 0;
  Instant now_{};
  std::optional<Instant> held_, hold_until_;  // sending nothing, so that what waits gets through
  std::optional<int> before_silence_;         // one_in_ then
  double downlink_s_ = 0;                     // delay of the newest message
  std::optional<double> least_downlink_s_;
  struct Waited {
    Instant at;
    double wait_s = 0;
  };
  std::deque<Waited> recent_, uplink_;  // both ways; the way up alone, for less long
  std::optional<Instant> heard_, late_since_, soon_since_;
  std::optional<Instant> tried_, fewer_;  // the last try of more, while it holds; when fewer were sent last
  double patience_s_;
};

}  // namespace coslam
