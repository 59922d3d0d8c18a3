// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/time.h"
#include "server/fleet/record/link_to_nobody.h"
#include "server/fleet/record/recording.h"

namespace coslam {

struct Repeats {
  int times = 1;       // each recorded agent plays its recording
  int fleets = 1;      // copies of the recorded agents, side by side, each starting at another part of the recording
  double pause_s = 1;  // between two times
};

// The server's end of links whose agents play one recording again and again, for trials of hours: each time as new runs
// of the same names, in later time. Agents of another fleet have names with -2, -3, ... behind them. What happens comes
// in the order of played time, which does not pass while the loop works: every replay is the same. What is sent to the
// agents goes nowhere. Of one thread.
class RepeatedLink : public LinkToNobody {
 public:
  // Throws UserError, as next_event() does.
  RepeatedLink(const std::filesystem::path& file, const Repeats& repeats);

  const RecordingHead& head() const { return head_; }
  TimeNs monotonic_ns() const { return head_.monotonic_ns + now_ns_; }
  TimeNs utc_ns() const { return head_.utc_ns + now_ns_; }
  TimeNs now_ns() const { return now_ns_; }  // played
  TimeNs length_ns() const;                  // played time of all repetitions
  bool over() const;

  std::optional<ServerEvent> next_event(std::chrono::milliseconds timeout) override;

 private:
  struct Fleet {
    int number = 0, time = 0;
    TimeNs begins_ns = 0;  // start of the present repetition, played time
    std::unique_ptr<Recording> recording;
    std::optional<TimedEvent> next;
    TimeNs due_ns = 0;  // played time of `next`
  };
  void take_next(Fleet& fleet);
  void begin(Fleet& fleet);
  ServerEvent as_of(const Fleet& fleet, ServerEvent event) const;

  std::filesystem::path file_;
  Repeats repeats_;
  RecordingHead head_;
  TimeNs first_ns_ = 0;   // when the first recorded frame was taken
  TimeNs period_ns_ = 0;  // played time from one repetition of a fleet to the next
  std::vector<Fleet> fleets_;
  TimeNs now_ns_ = 0;
};

}  // namespace coslam
