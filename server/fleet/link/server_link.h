// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include "common/base/time.h"
#include "common/model/agent_images.h"
#include "common/model/agent_pose.h"
#include "common/model/map_patch.h"
#include "common/model/moving_state.h"
#include "common/model/public_sample.h"
#include "common/model/session.h"
#include "common/model/thumbnail.h"
#include "common/model/track_frame.h"
#include "common/wire/counters.h"

namespace coslam {

// A frame with the replies that travelled apart. Frames of one run come in ascending order, none twice. Live only: a
// reply that came too late for its own frame rides with the next one, so look at its `frame`.
struct JoinedFrame {
  TrackFrame frame;
  std::optional<PatchReply> patches;
  std::optional<DescriptorReply> descriptors;
  std::optional<Instant> arrived;  // the frame itself, on a link that takes time
};

// Event of an agent that gave no sign of life for a while (killed, or the network is cut). Its next frame means that it
// is back.
struct AgentSilent {
  std::string agent;
  RunId agent_run;
};

// The agent ended, or was silent so long that the middleware gave it up. A Hello comes again if the run comes back.
struct AgentGone {
  std::string agent;
  RunId agent_run;
};

// A Hello whose name is known but whose run is new means that the agent was restarted.
using ServerEvent = std::variant<Hello, JoinedFrame, AgentStatus, AgentSilent, AgentGone>;

// Counts of what the link lost or did twice, for the report.
struct ServerLinkCounts {
  std::uint64_t dropped_frames = 0;  // live: events dropped because the map thread was late
  std::uint64_t late_replies = 0;    // replies that missed their frame
  std::uint64_t resent_patches = 0;  // lock-step: answers to a frame that came again
};

// The server's end of the links to all agents: over DDS (dds_server_link.h) or in one process (inline_link.h).
// Threads: next_event, send, send_status and refuse belong to one thread, the map thread; the rest from any.
class ServerLink {
 public:
  virtual ~ServerLink() = default;

  // The next event, waiting up to `timeout`; empty when there is none. Only what was checked and admitted gets here.
  // Throws UserError, before any event, when another map server is at work in the same domain: a new server says
  // nothing for 0.6 s, and for 2.5 to 3.5 s when it knows of another one that may just be starting too.
  virtual std::optional<ServerEvent> next_event(std::chrono::milliseconds timeout) = 0;

  // Whether the link takes part; false at first, while it is silent, see next_event().
  virtual bool at_work() const = 0;

  // The options with which coslam-agent comes here; empty: agents do not come by themselves.
  virtual std::string join_options() const { return {}; }

  // Sends a patch to the run it names; ignored when that run is gone or replaced. Never waits.
  virtual void send(const MapPatch& patch) = 0;
  // Sends to everybody who reads it; over DDS only. Never waits.
  virtual void send(const MovingState& state) = 0;
  virtual void send(const AgentPose& pose) = 0;
  // Sends to the run it names.
  virtual void send(const AgentImages& images) = 0;
  // Public messages, for bridges; from any thread.
  virtual bool public_wanted() const { return false; }
  virtual void send_public(const PublicSample& /*sample*/) {}
  // Returns an agent's newest image of the last 5 s, if there is one, and asks the agent for a new one, once a second
  // at most. Callable from any thread.
  virtual std::optional<Thumbnail> thumbnail(const std::string& /*agent*/) { return std::nullopt; }
  // Publishes the status; the link adds its own refusals (same name twice, another protocol) to status.refused.
  virtual void send_status(const ServerStatus& status) = 0;
  // Turns an agent away after its Hello, with one sentence for its user; nothing of that run is delivered any more.
  virtual void refuse(const Hello& hello, const std::string& reason) = 0;

  virtual LinkBytes bytes(const std::string& agent) const = 0;
  virtual ServerLinkCounts counts() const = 0;
  virtual const RejectionCounts& rejections() const = 0;
};

}  // namespace coslam
