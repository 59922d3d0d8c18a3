// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/tools/status/census.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <vector>

#include "common/base/text.h"
namespace coslam {
namespace {

constexpr std::size_t kMostUnanswered = 256;  // frames

double seconds(Instant from, Instant to) { return std::chrono::duration<double>(to - from).count(); }

template <class... Values>
std::string format(const char* pattern, Values... values) {
  std::array<char, 256> text{};
  std::snprintf(text.data(), text.size(), pattern, values...);
  return text.data();
}

const char* word_of(PoseState state) {
  switch (state) {
    case PoseState::kTracked:
      return "tracked";
    case PoseState::kLost:
      return "lost";
    case PoseState::kNone:
      break;
  }
  return "none";
}

const char* word_of(AgentState state) {
  switch (state) {
    case AgentState::kRunning:
      return "running";
    case AgentState::kFinished:
      return "finished";
    case AgentState::kWaiting:
      break;
  }
  return "waiting";
}

}  // namespace

void Census::add(const ServerStatus& status, std::uint64_t, Instant) { servers_[status.server_run] = status; }

void Census::add(const Hello& hello, std::uint64_t bytes, Instant now) {
  heard(hello.agent, hello.agent_run, bytes, now);
}

void Census::add(const AgentStatus& status, std::uint64_t bytes, Instant now) {
  heard(status.agent, status.agent_run, bytes, now).status = status;
}

void Census::add(const TrackFrame& frame, std::uint64_t bytes, Instant now) {
  Agent& agent = heard(frame.agent, frame.agent_run, bytes, now);
  // In lock-step a frame may come again.
  if (!agent.unanswered.emplace(frame.frame, now).second) return;
  if (agent.unanswered.size() > kMostUnanswered) agent.unanswered.erase(agent.unanswered.begin());
  if (agent.frames++ == 0) agent.first_frame = now;
  agent.last_frame = now;
}

void Census::add(const PatchReply& reply, std::uint64_t bytes, Instant now) {
  heard(reply.agent, reply.agent_run, bytes, now);
}

void Census::add(const DescriptorReply& reply, std::uint64_t bytes, Instant now) {
  heard(reply.agent, reply.agent_run, bytes, now);
}

void Census::add(const MapPatch& patch, std::uint64_t bytes, Instant now) {
  Agent& agent = heard(patch.agent, patch.agent_run, 0, now);
  agent.bytes_down += bytes;
  agent.group = patch.group;
  const auto frame = agent.unanswered.find(patch.after_frame);
  if (frame == agent.unanswered.end()) return;
  ++agent.answers;
  agent.lag_s += seconds(frame->second, now);
  agent.unanswered.erase(agent.unanswered.begin(), std::next(frame));
}

void Census::add(const MovingState& state, std::uint64_t, Instant) { moving_[{state.server_run, state.map}] = state; }

void Census::set_alive(RunId run, bool alive) { alive_[run] = alive; }

bool Census::alive(RunId run) const {
  const auto found = alive_.find(run);
  return found == alive_.end() || found->second;
}

Census::Agent& Census::heard(const std::string& name, RunId run, std::uint64_t bytes, Instant now) {
  const auto [at, is_new] = agents_.try_emplace(run);
  if (is_new) at->second.since = now;
  at->second.name = name;
  at->second.bytes_up += bytes;
  return at->second;
}

std::string Census::state_of(RunId run, const Agent& agent) const {
  for (const auto& [server_run, server] : servers_) {
    if (refusal_of(server, run)) return "refused";
  }
  if (!alive(run)) return "silent";
  return word_of(agent.status ? agent.status->state : AgentState::kWaiting);
}

std::string Census::line_of(RunId run, const Agent& agent, Instant now) const {
  const double played_s = seconds(agent.first_frame, agent.last_frame), heard_s = seconds(agent.since, now);
  const AgentStatus s = agent.status.value_or(AgentStatus());
  std::string line = format("%-16s %-8s %-8s", agent.name.c_str(), state_of(run, agent).c_str(), word_of(s.pose_state));
  line += agent.group == GroupId() ? format(" %5s", "-") : format(" %5u", agent.group.value);
  line += format(" %8u %7u %6u %8.1f", s.frames, s.dropped, s.tracks, s.frame_ms);
  line += format(" %6.1f", agent.frames > 1 && played_s > 0 ? (agent.frames - 1) / played_s : 0.0);
  line += agent.answers == 0 ? format(" %7s", "-") : format(" %7.1f", 1e3 * agent.lag_s / agent.answers);
  const auto kilobytes_per_s = [&](std::uint64_t bytes) {
    return heard_s > 0 ? 1e-3 * static_cast<double>(bytes) / heard_s : 0.0;
  };
  line += format(" %8.1f %9.1f\n", kilobytes_per_s(agent.bytes_up), kilobytes_per_s(agent.bytes_down));
  if (s.image_fault != ImageFault::kNone) {
    line += "  its images are not to be believed: " + std::string(words_of(s.image_fault).why) + "\n";
  }
  return line;
}

std::string Census::text(Instant now) const {
  std::string text;
  for (const auto& [run, s] : servers_) {
    const char* state = !alive(run) ? "silent" : s.stopping ? "stopping" : s.started ? "running" : "waiting";
    text += format("map server %s: %s, %u frame sets, %u points\n", format_hex(run.value).c_str(), state, s.frame_sets,
                   s.points);
  }
  if (servers_.empty()) text += "no map server\n";
  text += format("%-16s %-8s %-8s %5s %8s %7s %6s %8s %6s %7s %8s %9s\n", "agent", "state", "pose", "group", "frames",
                 "dropped", "tracks", "ms/frame", "Hz", "lag ms", "kB/s up", "kB/s down");
  std::vector<std::string> lines;
  for (const auto& [run, agent] : agents_) lines.push_back(line_of(run, agent, now));
  std::ranges::sort(lines);
  for (const std::string& line : lines) text += line;
  for (const auto& [key, state] : moving_) {
    const char* unit = state.scale_known ? "m" : "units";
    for (const MovingObjectState& o : state.objects) {
      text += format("object %u: %u points at %.2f %.2f %.2f, %.2f %s/s, %.2f x %.2f x %.2f %s\n", o.object.value,
                     static_cast<unsigned>(o.points), o.centroid.x(), o.centroid.y(), o.centroid.z(),
                     o.velocity_per_s.norm(), unit, o.extent.x(), o.extent.y(), o.extent.z(), unit);
    }
  }
  // The server remembers those that have left.
  for (const auto& [run, server] : servers_) {
    for (const std::string& name : server.agents) {
      const bool here = std::ranges::any_of(agents_, [&](const auto& a) { return a.second.name == name; });
      if (!here) text += format("%-16s %-8s\n", name.c_str(), "gone");
    }
    for (const Refusal& refusal : server.refused) {
      if (agents_.contains(refusal.agent_run)) text += "refused: " + refusal.reason + "\n";
    }
  }
  return text;
}

}  // namespace coslam
