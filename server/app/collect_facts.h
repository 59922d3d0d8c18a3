// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/app/roster.h"
#include "server/estimator/map_server.h"
#include "server/fleet/link/server_link.h"
#include "server/fleet/sync/set_clock.h"
#include "server/keep/loop_facts.h"

namespace coslam {

// Collects what the server's loop knows beside the map, but for the folder of its result. finishing: the run is over,
// and images count as their frames are in the map.
LoopFacts collect_facts(const Roster& roster, const SetClock& sets, const ServerLink& link, const MapServer& server,
                        bool finishing);

}  // namespace coslam
