// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/config/config.h"
#include "server/app/server_config.h"
#include "server/fleet/record/recorded_event.h"

namespace coslam {

// Keys that a recording holds and a replay takes. The wire's are not among them: they name files and networks of the
// machine that recorded.
struct RecordedConfig {
  std::vector<std::string> agents;
  ServerConfig server;
};

template <class V>
void describe(V& v, RecordedConfig& c) {
  v.field("agents", c.agents, "see ServerOptions");
  v.section("server", c.server);
}

inline RecordingHead recording_head(RunId server_run, const RecordedConfig& config) {
  return {.server_run = server_run, .configuration = config::dump_json(config)};
}

// Parses the configuration in a recording's head; throws UserError. file: where the head is from. Sections that a
// recording has under an earlier name are found.
RecordedConfig recorded_config(const RecordingHead& head, const std::filesystem::path& file);

}  // namespace coslam
