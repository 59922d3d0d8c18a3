// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "server/fleet/link/server_link.h"
#include "server/fleet/record/recorded_event.h"
#include "server/fleet/record/recording_file.h"

namespace coslam {

struct TimedEvent {
  TimeNs t_ns = 0;  // since the recording began
  ServerEvent event;
};

// Reads what a server heard, event by event, with the order that a link keeps. Every function throws UserError when the
// file is no such thing. Thread-compatible.
class Recording {
 public:
  explicit Recording(const std::filesystem::path& file);

  const RecordingHead& head() const { return head_; }
  // Next event; empty at the end, or where the recording was cut off.
  std::optional<TimedEvent> next();
  bool cut_off() const { return over_ && !ended_; }
  // Time of the event that was read last; at the end the duration of the recording.
  TimeNs t_ns() const { return t_ns_; }

 private:
  struct Run {
    std::string agent;
    std::optional<FrameId> last;
  };
  bool in_order(const ServerEvent& event);

  RecordReader reader_;
  RecordingHead head_;
  std::map<RunId, Run> runs_;
  TimeNs t_ns_ = 0;
  bool over_ = false, ended_ = false;
};

struct RecordingSummary {
  RecordingHead head;
  TimeNs t_ns = 0;  // duration
  bool cut_off = false;
};
// Reads all of it once, so that one that is damaged is told of before anything starts. Throws UserError.
RecordingSummary check_recording(const std::filesystem::path& file);

}  // namespace coslam
