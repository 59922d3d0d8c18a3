// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/base/ids.h"
#include "common/base/metrics.h"
#include "common/model/image_account.h"
#include "common/model/session.h"
#include "server/keep/verdict.h"

namespace coslam {

// Facts about an agent that the server's loop knows, beside the map.
struct AgentFacts {
  std::string name;
  CameraId camera;
  AgentStatus status;   // the newest, without its report
  ImageAccount images;  // counts so far
  std::uint64_t bytes_up = 0, bytes_down = 0;
  double wait_s = 0;                // how much longer than at best its newest frame was under way
  std::optional<PathVerdict> path;  // newest verdict; empty: none yet, or the agent is not in the main map
};

// Durations of one stage over the whole run, ms.
struct StageTime {
  double p50 = 0, p95 = 0, p99 = 0, sum = 0;
  std::uint64_t count = 0;
};
inline StageTime stage_time_of(const DurationHistogram& h) {
  return {h.percentile_ms(50), h.percentile_ms(95), h.percentile_ms(99), h.mean_ms() * static_cast<double>(h.count()),
          h.count()};
}

// Facts that the server's loop knows, beside the map.
struct LoopFacts {
  std::vector<AgentFacts> agents;
  std::string result;                             // RESULT folder of the run; empty: none
  std::string join;                               // options with which coslam-agent comes here; empty: none does
  double memory_mib = 0;                          // memory of the process
  bool at_work = false;                           // no longer looking for another server
  bool finishing = false;                         // the run is over, the map is adjusted as a whole
  StageTime watching;                             // time that the map thread spends on showing the map
  std::map<std::string, std::uint64_t> lost;      // frames and replies that were not used, by what became of them
  std::map<std::string, std::uint64_t> rejected;  // samples and datagrams, by reason
};

}  // namespace coslam
