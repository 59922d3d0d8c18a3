// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>

#include "common/base/time.h"

namespace coslam {

// How many bytes a second of replies a live agent sends beside its frames: more while frames come as soon as ever
// though replies wait to be sent, half as soon as frames wait for them. It begins with what a narrow link has left
// beside frames and grows fast until frames waited for the first time, which costs it seven eighths; never far beyond
// what is seen to arrive. Pure: time is an argument. Thread-compatible.
class ReplyRate {
 public:
  // A message of the server. uplink_wait_s: how much longer than at best the newest frame took. round_s: since that
  // frame was sent. delivered_bytes: of all replies that were sent before it.
  void heard(double uplink_wait_s, double round_s, bool replies_wait, double delivered_bytes, Instant now);
  double bytes_per_s() const { return bytes_per_s_; }
  // Maximum of bytes that the server is not known to have yet: a queue in the link is noticed only when it is long.
  double unanswered_bytes() const;
  // Frames had to wait for replies before: the link does not carry whatever is given to it.
  bool limited() const { return halved_.has_value(); }
  bool limited_since(Instant start) const { return halved_ && *halved_ >= start; }

 private:
  void note_delivered(double bytes, Instant now);

  struct Delivered {
    Instant at;
    double bytes = 0;
  };
  std::deque<Delivered> delivered_;
  double arrive_bytes_per_s_ = 0;  // lately, at most
  static constexpr double kAtFirst_bytes_per_s = 8e3;
  double bytes_per_s_ = kAtFirst_bytes_per_s;
  std::optional<double> least_round_s_;
  std::optional<Instant> heard_, halved_;
};

}  // namespace coslam
