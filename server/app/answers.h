// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "server/app/roster.h"
#include "server/estimator/map_server.h"
#include "server/fleet/link/server_link.h"
#include "server/fleet/sync/set_clock.h"

namespace coslam {

// Sends what agents and others are told of a frame set: each agent its patch, everybody what moves and where the agents
// are.
void send_answers(const FrameSet& set, std::vector<MapPatch> patches, const MapServer& server, Roster& roster,
                  const SetClock& sets, const std::function<TimeNs()>& monotonic_ns, ServerLink* link);

// Status of the map and of who takes part; when play starts and whether the server stops is not filled in.
ServerStatus status_of(const MapServer& server, const Roster& roster);

// Says in the log that an agent's images are not to be believed any more, or are again.
void log_images(const AgentStatus& status);

}  // namespace coslam
