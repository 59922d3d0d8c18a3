// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "server/link/server_link.h"
#include "server/map_server.h"
#include "server/sync/frame_set_sync.h"

namespace coslam {

// An agent that took part, and what it said of itself last.
struct ReportedAgent {
  std::string name;
  CameraId camera;
  AgentStatus last_status;
};

// report.json: what a run did, how long it took and what it cost. configuration: the one in effect.
nlohmann::ordered_json make_report(const MapServer& server, const FrameSetSync& sync, const ServerLink& link,
                                   const std::vector<ReportedAgent>& agents,
                                   const nlohmann::ordered_json& configuration);

}  // namespace coslam
