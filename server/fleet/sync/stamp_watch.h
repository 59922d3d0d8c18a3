// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/base/ids.h"
#include "common/base/time.h"
#include "server/fleet/sync/clock_estimate.h"

namespace coslam {

// Brings the stamps of live agents onto one time, so that no agent's clock can hurt another. What tells of a clock is
// how long after their stamps frames arrive: an agent joins with a lag like that of the others (of the server's own
// clock while there are none), and afterwards only ever falls behind, since links delay and never hasten. Frames that
// are more than half a second earlier than that are held back. When they go on to come at one lag, the clock was set,
// and the stamps are corrected by what it was set; when they do not, their stamps are no times. Below a second, the
// four stamps of exchanges tell the offset far better, for stamps that are of the agent's clock. Pure: time is an
// argument; the server's may begin anywhere but never steps. Thread-compatible.
class StampWatch {
 public:
  // Takes the expected stamps of frames that arrive at the server's time 0: UTC for cameras, played time for
  // recordings. The first agent may fit either.
  explicit StampWatch(std::vector<TimeNs> expected_at_zero_ns) : expected_ns_(std::move(expected_at_zero_ns)) {}
  void expect(TimeNs at_zero_ns) { expected_ns_.push_back(at_zero_ns); }

  // Begins anew for an agent that restarted. Frames that come more than twice as densely as rate_hz says, and at
  // more than 60 Hz, or at more than 530 Hz whatever it says, are thinned: each would be a frame set of its own, which
  // the others' wait behind.
  void add(CameraId camera, const std::string& name, double rate_hz);
  // Takes in an exchange with an agent whose stamps are of its own clock.
  void exchange(CameraId camera, const ClockExchange& stamps);
  // Time when a frame that arrives now was taken; ascending. Empty: it is not to be used.
  std::optional<TimeNs> place(CameraId camera, TimeNs capture_ns, TimeNs now_ns);

  // How much longer than at best its newest frame was under way.
  double wait_s(CameraId camera) const;
  // Correction that is added to an agent's stamps.
  TimeNs correction_ns(CameraId camera) const;
  std::uint64_t refused() const { return refused_; }
  // Sentences for the log since the last call.
  std::vector<std::string> take_warnings() { return std::exchange(warnings_, {}); }

 private:
  // The least of what was seen: it rises and falls by no more than so much each second.
  struct Floor {
    std::optional<double> least_s;
    double at_s = 0;
    void add(double value_s, double now_s, double most_rise, double most_fall);
  };
  struct Held {
    double lag_s = 0, now_s = 0;
  };
  struct Agent {
    std::string name;
    TimeNs least_step_ns = 1;
    TimeNs correction_ns = 0;
    bool trusted = false;
    std::optional<TimeNs> newest_ns;  // given out
    double lag_s = 0, heard_s = 0;    // lag and arrival of the newest frame that was used
    Floor alone, beside_others;       // recent minimum of the lag, and of its difference to that of the others
    Floor ever;                       // minimum of the lag over the whole run: it changes no more than clocks drift
    std::deque<Held> held;            // lags of the frames that were held back in succession
    bool warned = false;              // a warning was given that its stamps are no times
    ClockEstimate clock;
  };

  std::optional<double> lag_of_others(CameraId camera, double now_s) const;
  double clock_lag_near(double lag_s) const;
  bool is_by_clock(double lag_s) const;
  double expected_lag_s(const Agent& agent, std::optional<double> others_s, double lag_s) const;
  bool fits(const Agent& agent, std::optional<double> others_s, double lag_s) const;
  bool correct(Agent& agent, std::optional<double> others_s, double lag_s, double now_s);
  void say_corrected(const Agent& agent, double by_s);

  std::vector<TimeNs> expected_ns_;
  std::map<CameraId, Agent> agents_;
  std::uint64_t refused_ = 0;
  std::vector<std::string> warnings_;
};

}  // namespace coslam
