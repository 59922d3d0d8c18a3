// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/model/image_account.h"
#include "common/model/image_fault.h"
#include "server/estimator/map_server.h"
#include "server/fleet/link/server_link.h"
#include "server/fleet/sync/stamp_watch.h"

namespace coslam {

// An agent that took part, and what it said of itself last.
struct ReportedAgent {
  std::string name;
  CameraId camera;
  AgentStatus last_status;
  ImageAccount images;
  std::string problem;  // a sentence for the user about problems with the images; empty: none
};

// Frames that did not become part of a frame set that was used.
struct FrameCounts {
  std::uint32_t late = 0;        // their instant was over
  std::uint32_t overflowed = 0;  // too many waited
  std::uint32_t sets_left_out = 0;
  const StampWatch& stamps;
};

// report.json: what a run did, how long it took and what it cost. adjusted: the map is, as a whole; configuration: the
// one in effect.
nlohmann::ordered_json make_report(const MapServer& server, const ServerLink& link, const FrameCounts& counts,
                                   const std::vector<ReportedAgent>& agents, bool adjusted,
                                   const nlohmann::ordered_json& configuration);

// How many images an agent did not believe, by what was wrong with them, from what it says of itself at its end.
std::array<std::uint64_t, kImageFaults> faults_of(const std::string& report_json);

// The part of it that a map alone can tell: who is in which map, and with how many frames.
nlohmann::ordered_json make_map_report(const MapServer& server);

}  // namespace coslam
