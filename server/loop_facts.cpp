// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <fstream>

#include "server/server_loop.h"

namespace coslam {
namespace {

double resident_memory_mib() {
  std::ifstream statm("/proc/self/statm");
  long all = 0, resident = 0;
  statm >> all >> resident;
  return static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1 << 20);
}

}  // namespace

std::vector<ReportedAgent> ServerLoop::agents() const {
  std::vector<ReportedAgent> agents;
  for (const auto& [name, agent] : agents_) agents.push_back({name, agent.camera, agent.last_status});
  return agents;
}

LoopFacts ServerLoop::facts() const {
  LoopFacts out;
  for (ReportedAgent& agent : agents()) {
    agent.last_status.report_json.clear();
    const LinkBytes bytes = link_.bytes(agent.name);
    out.agents.push_back({agent.name, agent.camera, std::move(agent.last_status), bytes.up, bytes.down,
                          lockstep_ ? 0 : stamps_.wait_s(agent.camera),
                          to_seconds(stamps_.correction_ns(agent.camera))});
  }
  out.result = result_.string();
  out.memory_mib = resident_memory_mib();
  out.at_work = link_.at_work();
  out.finishing = stopping_;
  const ServerLinkCounts counts = link_.counts();
  out.lost = {{"late_frames", sync_.late()},
              {"overflowed_frames", sync_.overflowed()},
              {"sets_left_out", left_out_},
              {"frames_out_of_time", stamps_.refused()},
              {"dropped_frames", counts.dropped_frames},
              {"late_replies", counts.late_replies}};
  for (std::size_t i = 0; i < kRejectionCount; ++i) {
    const auto reason = static_cast<Rejection>(i);
    out.rejected[std::string(name_of(reason))] = link_.rejections()[reason];
  }
  return out;
}

}  // namespace coslam
