// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/base/time.h"
#include "common/model/agent_images.h"
#include "common/model/map_patch.h"
#include "common/model/moving_state.h"
#include "common/model/session.h"
#include "common/model/track_frame.h"

namespace coslam {

// The participants of a DDS domain and their condition, from the messages between them while somebody listens. Pure:
// time is an argument. Thread-compatible.
class Census {
 public:
  // A message of whatever type, and its bytes on the network.
  void add(const ServerStatus& status, std::uint64_t bytes, Instant now);
  void add(const Hello& hello, std::uint64_t bytes, Instant now);
  void add(const AgentStatus& status, std::uint64_t bytes, Instant now);
  void add(const TrackFrame& frame, std::uint64_t bytes, Instant now);
  void add(const PatchReply& reply, std::uint64_t bytes, Instant now);
  void add(const DescriptorReply& reply, std::uint64_t bytes, Instant now);
  void add(const MapPatch& patch, std::uint64_t bytes, Instant now);
  void add(const AgentImages& images, std::uint64_t bytes, Instant now);
  void add(const MovingState& state, std::uint64_t bytes, Instant now);
  void set_alive(RunId run, bool alive);  // liveliness of an agent or a server

  bool empty() const { return servers_.empty() && agents_.empty(); }
  // A line for each server, each agent and each object that moves; rates are over the time since an agent was first
  // heard.
  std::string text(Instant now) const;
  // The census for programs, on one line: {"servers": [...], "agents": [...], "objects": [...]}.
  std::string json(Instant now) const;

 private:
  struct Agent {
    std::string name;
    Instant heard_since;
    std::optional<AgentStatus> status;
    std::optional<ImageAccount> images;  // counts of the server
    bool complete = false;               // the server says that the agent has ended
    std::uint64_t bytes_up = 0, bytes_down = 0;
    int frames = 0;
    Instant first_frame, last_frame;
    std::map<FrameId, Instant> unanswered;
    int answers = 0;
    double lag_s = 0;  // sum over the answers
    GroupId group;
  };

  // Figures of an agent for the text and JSON.
  struct Figures {
    std::string name, state, pose;
    std::optional<std::uint32_t> group;
    AgentStatus status;
    std::optional<ImageAccount> images;  // counts of its server
    double rate_hz = 0;
    std::optional<double> lag_ms;
    double up_kb_s = 0, down_kb_s = 0;
    std::string refused;  // why; empty: it is not

    std::uint64_t captured() const;
  };

  Agent& heard(const std::string& name, RunId run, std::uint64_t bytes, Instant now);
  std::string refusal(RunId run) const;
  std::string state_of(RunId run, const Agent& agent) const;
  const char* state_of(RunId run, const ServerStatus& server) const;
  Figures figures_of(RunId run, const Agent& agent, Instant now) const;
  std::vector<Figures> agents(Instant now) const;  // sorted by name
  std::vector<std::string> gone_agents() const;    // agents that the server remembers
  bool alive(RunId run) const;

  std::map<RunId, ServerStatus> servers_;
  std::map<RunId, Agent> agents_;
  std::map<std::pair<RunId, MapId>, MovingState> moving_;
  std::map<RunId, bool> alive_;  // absent: nothing to the contrary was heard
};

}  // namespace coslam
