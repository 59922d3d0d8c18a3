// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "server/fleet/link/server_link.h"
#include "server/fleet/record/recording_file.h"

// What a recording holds as records, and back. What agents sent is held as the messages of the wire, made and checked
// by its codec; tracks are coded alone. Equal to the bit after both ways.
namespace coslam {

// What it takes to repeat a run beside the events.
struct RecordingHead {  // NOLINT(bugprone-exception-escape): moving JSON throws nothing
  std::string version;  // of the program that recorded
  RunId server_run;     // poses of agents say whose map they are in
  TimeNs utc_ns = 0;    // when the recording began, by both clocks of its machine
  TimeNs monotonic_ns = 0;
  nlohmann::ordered_json configuration;  // in effect, see server/app/recorded_config.h
};

Record encode_head(const RecordingHead& head);
Record encode_event(const ServerEvent& event, TimeNs t_ns);

// What to tell the user of a head whose messages are of another protocol; else empty.
std::optional<std::string> foreign_protocol(const Record& record);
// Empty when the record is not one that the functions above make.
std::optional<RecordingHead> decode_head(const Record& record);
std::optional<ServerEvent> decode_event(const Record& record);

}  // namespace coslam
