// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/base/ids.h"
#include "common/base/time.h"
#include "common/geometry/camera_model.h"
#include "common/model/image_fault.h"
#include "common/model/track_frame.h"

namespace coslam {

constexpr std::uint16_t kProtocolVersion = 14;

// Playback mode of an agent's source.
enum class Pacing : std::uint8_t {
  kLive,      // real time: drops what it has no time for
  kLockstep,  // --rate max: frame n + 1 waits for the server's patch after frame n; nothing is dropped
};

// Sent once by an agent at start, kept by the middleware for late servers.
struct Hello {
  std::string agent;
  RunId agent_run;
  std::uint16_t protocol = kProtocolVersion;
  Pacing pacing = Pacing::kLive;
  double rate_hz = 30;  // nominal frame rate
  CameraModel camera;
};

enum class AgentState : std::uint8_t { kWaiting, kRunning, kFinished };

// A word from the server and the agent's answer, for what their clocks differ by. All 0: none.
struct ClockExchange {
  TimeNs sent_ns = 0;      // clock of the server
  TimeNs received_ns = 0;  // clock of the agent
  TimeNs replied_ns = 0;   // clock of the agent
  TimeNs arrived_ns = 0;   // clock of the server; not on the wire
};

// Heartbeat of an agent, once a second and on every change of state.
struct AgentStatus {
  std::string agent;
  RunId agent_run;
  AgentState state = AgentState::kWaiting;
  PoseState pose_state = PoseState::kNone;
  std::uint32_t frames = 0;                    // images sent
  std::uint32_t dropped = 0;                   // images not sent: no time for them, or the link carries less
  std::uint32_t left_out = 0;                  // images that were not to be believed
  ImageFault image_fault = ImageFault::kNone;  // why its images are not to be believed now; none: they are
  std::uint32_t tracks = 0;
  float frame_ms = 0;       // mean time of one step
  ClockExchange exchange;   // set when the stamps of the agent's images are of its own clock
  std::string report_json;  // when finished: stage times and byte counts, see docs/wire.md
  // Features of the last image, when the agent has finished: nobody can ask for them any more.
  std::optional<DescriptorReply> last_image;
};

// An agent that was turned away, with one sentence for its user (wrong protocol, name taken).
struct Refusal {
  RunId agent_run;
  std::string reason;
};

// Heartbeat of the server, once a second and on every change of state.
struct ServerStatus {
  RunId server_run;
  std::uint16_t protocol = kProtocolVersion;
  bool started = false;     // all expected agents are here: play
  bool stopping = false;    // the server ends: finish
  TimeNs start_utc_ns = 0;  // live replay: played time 0 is this instant
  std::uint32_t frame_sets = 0;
  std::uint32_t points = 0;
  std::vector<std::string> agents;  // the first 64 reach the others: name those that are here first
  std::vector<Refusal> refused;     // listed by run, since the agent that holds the name must not take it for itself
};

// Why the server turned this run away; empty when it did not.
std::optional<std::string> refusal_of(const ServerStatus& status, RunId agent_run);

}  // namespace coslam
