// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <algorithm>
#include <fstream>

#include "common/base/log.h"
#include "server/app/server_loop.h"

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
  const std::vector<MapFrames> maps = server_.maps();
  for (const auto& [name, agent] : agents_) {
    const ImageAccount images = account_of(agent, maps);
    agents.push_back({name, agent.camera, agent.last_status, images, problem_of(name, agent, images)});
  }
  return agents;
}

// A map that is older than this server holds frames of other days, and does not tell whose are of this one.
ImageAccount ServerLoop::account_of(const Agent& agent, const std::vector<MapFrames>& maps) const {
  if (server_.restored_until()) return agent.images.at_end(agent.images.frames_posed(), 0);
  std::uint64_t tracked = 0, in_other_maps = 0;
  for (const MapFrames& map : maps) {
    const auto frames = map.frames.find(agent.camera);
    if (frames == map.frames.end()) continue;
    (&map == &maps.front() ? tracked : in_other_maps) += static_cast<std::uint64_t>(frames->second);
  }
  return agent.images.at_end(tracked, in_other_maps);
}

// What the user should know of an agent's images; of agents that were named the report tells it.
std::string ServerLoop::problem_of(const std::string& name, const Agent& agent, const ImageAccount& images) const {
  constexpr std::uint64_t kWorthSaying = 5;
  const std::uint64_t placed = images[ImageFate::kTracked] + images[ImageFate::kInOtherMaps];
  if (agent.missed >= kWorthSaying) return late_images(name, agent.missed, images.captured(), agent.past_ns);
  return placed > 0 ? "" : name + " " + why_no_pose(images, faults_of(agent.last_status.report_json), agent.seen);
}

// To the agent and in the log, when it has ended and the fate of all is known.
void ServerLoop::say_images_of(const std::string& name, Agent& agent) {
  agent.said_images = true;
  const ImageAccount images = agent.images.so_far();
  const std::string problem = config_.expected_agents.empty() ? problem_of(name, agent, images) : "";
  if (!problem.empty()) log_warn(problem);
  link_.send({name, agent.run, server_.run(), images, true, problem});
}

std::string ServerLoop::problem() const {
  const bool ended = std::ranges::all_of(agents_, [](const auto& a) { return a.second.ended; });
  const auto problem = report_.find("problem");
  if (!ended) return "";
  return problem == report_.end() ? "" : problem->get<std::string>();
}

LoopFacts ServerLoop::facts() const {
  LoopFacts out;
  const std::vector<MapFrames> maps = stopping_ ? server_.maps() : std::vector<MapFrames>();
  for (const auto& [name, agent] : agents_) {
    AgentStatus status = agent.last_status;
    status.report_json.clear();
    const LinkBytes bytes = link_.bytes(name);
    AgentFacts& facts = out.agents.emplace_back();
    facts.name = name;
    facts.camera = agent.camera;
    facts.status = std::move(status);
    facts.images = stopping_ ? account_of(agent, maps) : agent.images.so_far();
    facts.bytes_up = bytes.up;
    facts.bytes_down = bytes.down;
    facts.wait_s = lockstep_ ? 0 : stamps_.wait_s(agent.camera);
  }
  out.result = result_.string();
  out.join = link_.join_options();
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
