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
#include "common/model/session.h"
#include "common/model/thumbnail.h"
#include "common/model/track_frame.h"
#include "common/wire/counters.h"
#include "common/wire/message_view.h"

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

// Message that goes down as it is. A status goes with the link's refusals, a request for a thumbnail by itself.
using ServerMessage = MessageView<SelectedTypes<goes_down, ServerStatus, ThumbnailRequest>>;

// The server's end of the links to all agents: over DDS (dds_server_link.h) or in one process (inline_link.h).
// Threads: next_event, send, send_status and refuse belong to the map thread; public messages and the rest to any.
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

  // Sends a message; never waits. One to a run (Topic::by_run) goes to the run that it names, and is ignored when that
  // run is gone or replaced. One to all goes to whoever reads it; over DDS only.
  virtual void send(const ServerMessage& message) = 0;
  // Whether a bridge reads public messages.
  virtual bool public_wanted() const { return false; }
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
