// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/app/collect_facts.h"

#include <unistd.h>

#include <fstream>
#include <utility>

namespace coslam {
namespace {

double resident_memory_mib() {
  std::ifstream statm("/proc/self/statm");
  long all = 0, resident = 0;
  statm >> all >> resident;
  return static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1 << 20);
}

}  // namespace

LoopFacts collect_facts(const Roster& roster, const SetClock& sets, const ServerLink& link, const MapServer& server,
                        bool finishing) {
  LoopFacts out;
  const std::vector<MapFrames> maps = finishing ? server.maps() : std::vector<MapFrames>();
  for (const auto& [name, agent] : roster.agents()) {
    AgentStatus status = agent.last_status;
    status.report_json.clear();
    const LinkBytes bytes = link.bytes(name);
    AgentFacts& facts = out.agents.emplace_back();
    facts.name = name;
    facts.camera = agent.camera;
    facts.status = std::move(status);
    facts.images = finishing ? Roster::account_of(agent, server, maps) : agent.images.so_far();
    facts.bytes_up = bytes.up;
    facts.bytes_down = bytes.down;
    facts.wait_s = sets.wait_s(agent.camera);
  }
  out.join = link.join_options();
  out.memory_mib = resident_memory_mib();
  out.at_work = link.at_work();
  out.finishing = finishing;
  const ServerLinkCounts counts = link.counts();
  out.lost = {{"late_frames", sets.late()},
              {"overflowed_frames", sets.overflowed()},
              {"sets_left_out", sets.sets_left_out()},
              {"frames_out_of_time", sets.stamps().refused()},
              {"dropped_frames", counts.dropped_frames},
              {"late_replies", counts.late_replies}};
  for (std::size_t i = 0; i < kRejectionCount; ++i) {
    const auto reason = static_cast<Rejection>(i);
    out.rejected[std::string(name_of(reason))] = link.rejections()[reason];
  }
  return out;
}

}  // namespace coslam
