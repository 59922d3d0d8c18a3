// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "server/fleet/link/server_link.h"
#include "server/fleet/record/recording_file.h"

// Encodes the content of a recording as records, and decodes it. Messages of agents are stored as those of the wire,
// made and checked by its codec; tracks are coded without reference frames. A round trip is equal to the bit.
namespace coslam {

// Data that is needed to repeat a run, beside the events.
struct RecordingHead {  // NOLINT(bugprone-exception-escape): moving JSON throws nothing
  std::string version;  // version of the recording program
  RunId server_run;     // poses of agents say whose map they are in
  TimeNs utc_ns = 0;    // when the recording began, by both clocks of its machine
  TimeNs monotonic_ns = 0;
  nlohmann::ordered_json configuration;  // in effect, see server/app/recorded_config.h
};

Record encode_head(const RecordingHead& head);
Record encode_event(const ServerEvent& event, TimeNs t_ns);

// Sentence for the user when the messages of the head are of another protocol; else empty.
std::optional<std::string> foreign_protocol(const Record& record);
// Decodes a record; empty when it is not one that the functions above make.
std::optional<RecordingHead> decode_head(const Record& record);
std::optional<ServerEvent> decode_event(const Record& record);

}  // namespace coslam
