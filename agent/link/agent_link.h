// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>
#include <vector>

#include "common/model/agent_images.h"
#include "common/model/map_patch.h"
#include "common/model/session.h"
#include "common/model/track_frame.h"
#include "common/wire/counters.h"
#include "common/wire/message_view.h"

namespace coslam {

// Replies that did not go with their frame.
struct RepliesWaiting {
  bool patches = false, descriptors = false;
  double sent_bytes = 0;  // size of all replies sent since the start

  bool any() const { return patches || descriptors; }
};

struct ReplyLimits {
  double bytes_a_frame = 0;  // maximum per frame; the rest waits for the next
  double up_to_bytes = 0;    // maximum of sent_bytes: limits what the server is not known to have yet
  // Lost ones are sent again soon unless the link is narrow, where what seems lost is mostly waiting.
  bool narrow_link = false;
};

// Message that goes up as it is. The hello goes by itself, and a frame goes along with replies.
using AgentMessage = MessageView<SelectedTypes<goes_up, Hello, TrackFrame, PatchReply, DescriptorReply>>;

// An agent's end of the link to the map server: over DDS (dds_agent_link.h) or in one process
// (deploy/coslam/run/inline_link.h). The hello goes out at construction and stays available to servers that start
// later. Nothing here waits for the network except wait_patch and wait_server_status, up to their timeout. Threads:
// send of a frame, wait_patch and take_patches belong to one thread; everything else may be called from any.
class AgentLink {
 public:
  virtual ~AgentLink() = default;

  // Sends one frame and replies: its own, or descriptors of an earlier one. Sets the frame's patches_sent, and its
  // descriptors_sent if it has any, from those that leave with it.
  virtual void send(TrackFrame frame, const std::optional<PatchReply>& patches,
                    const std::optional<DescriptorReply>& descriptors) = 0;
  virtual void send(const AgentMessage& message) = 0;
  // The server asked for a thumbnail since the last call.
  virtual bool take_thumbnail_request() { return false; }
  // Sets the limits of replies from now on.
  virtual void limit_replies(const ReplyLimits&) {}
  virtual RepliesWaiting waiting() const { return {}; }

  // Lock-step replay. The next patch in order of sequence; waits while there is none. Empty at the timeout, and at once
  // when the patch that answers `after_frame` was returned before. While the answer is due, the last frame sent is sent
  // again every 300 ms, since frames travel best effort. Use:
  //   do patch = wait_patch(frame, t); if (patch) apply(*patch); while (patch && patch->after_frame < frame);
  virtual std::optional<MapPatch> wait_patch(FrameId after_frame, std::chrono::milliseconds timeout) = 0;
  // Live. All patches that arrived since the last call, in order of sequence; never waits.
  virtual std::vector<MapPatch> take_patches() = 0;

  // Newest status of the server; empty before the first. Its server_run changes when the server was restarted.
  virtual std::optional<ServerStatus> server_status() const = 0;
  // Waits for a status that arrived after the last call of this function; empty at the timeout.
  virtual std::optional<ServerStatus> wait_server_status(std::chrono::milliseconds timeout) = 0;
  // Whether the server gives signs of life; false before the first status and while it is silent (killed, or the
  // network is cut).
  virtual bool server_alive() const = 0;

  // The server's newest account of this run's images; empty before the first.
  virtual std::optional<AgentImages> images() const { return std::nullopt; }

  // Offset of this machine's clock to the server's, positive when ahead: the minimum over all statuses of arrival by
  // this clock minus sending by the server's. Empty while the only status may have been kept for late joiners.
  virtual std::optional<double> clock_ahead_s() const { return std::nullopt; }

  virtual LinkBytes bytes() const = 0;
  virtual const RejectionCounts& rejections() const = 0;
};

// Throws UserError when a server would not understand this hello: bad name, bad camera. Every link begins with it.
void require_valid(const Hello& hello);

}  // namespace coslam
