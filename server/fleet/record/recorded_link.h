// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>

#include "common/base/time.h"
#include "server/fleet/record/link_to_nobody.h"
#include "server/fleet/record/recording.h"

namespace coslam {

// The server's end of links whose agents are a recording: gives the events that a server heard, at their times. What
// is sent to the agents goes nowhere.
//
// Time is that of the recording. At a rate it passes with the clock of the machine, times the rate. Without one it
// passes as the loop waits: it stands still while the loop works, and next_event() brings it to the next event at once,
// so that every replay sees the same times. Of one thread.
class RecordedLink : public LinkToNobody {
 public:
  // rate: of real time; 0: as fast as the loop takes the events. Throws UserError, as next_event() does.
  explicit RecordedLink(const std::filesystem::path& file, double rate = 0);

  const RecordingHead& head() const { return recording_.head(); }
  // Present time by the clocks of the recorded machine.
  TimeNs monotonic_ns() const { return recording_.head().monotonic_ns + now_ns(); }
  TimeNs utc_ns() const { return recording_.head().utc_ns + now_ns(); }
  TimeNs now_ns() const;  // since the recording began
  bool over() const;      // every event was given, and the time after the last one has passed

  std::optional<ServerEvent> next_event(std::chrono::milliseconds timeout) override;

 private:
  TimeNs due_ns() const { return next_ ? next_->t_ns : recording_.t_ns(); }
  void wait(TimeNs longest_ns);

  Recording recording_;
  const double rate_;
  const TimeNs opened_ns_;  // clock of this machine
  TimeNs stepped_ns_ = 0;   // without a rate: what time it is
  std::optional<TimedEvent> next_;
};

}  // namespace coslam
