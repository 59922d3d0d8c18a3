// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "common/model/agent_images.h"
#include "common/model/map_patch.h"
#include "common/model/session.h"
#include "common/model/thumbnail.h"
#include "common/wire/counters.h"

namespace coslam {

// Messages that an agent received from its server: patches in order of sequence, and the newest status. While its
// server gives signs of life, no other run is heard; then the first message of a new one replaces it for good, so that
// two servers at once cannot toss the agent to and fro. Thread-compatible.
class Inbox {
 public:
  static constexpr std::size_t kCapacity =
      512;  // patches; the oldest makes room, and the gap makes the agent ask again

  explicit Inbox(RunId agent_run) : agent_run_(agent_run) {}

  void set_server_alive(bool alive) { server_alive_ = alive; }

  // Takes a message; the result names a reason when it was refused, or when something was lost.
  std::optional<Rejection> add(MapPatch patch);
  std::optional<Rejection> add(ServerStatus status);
  std::optional<Rejection> add(AgentImages images);
  std::optional<Rejection> add(const ThumbnailRequest& request);

  std::optional<MapPatch> pop();
  // Newest frame that the present server has answered, whether the answer was popped or not.
  std::optional<FrameId> acknowledged() const { return acknowledged_; }
  // Whether the patch that answers this frame, or a later one, was popped.
  bool answered(FrameId frame) const { return credit_ && *credit_ >= frame; }

  const std::optional<ServerStatus>& status() const { return status_; }
  const std::optional<AgentImages>& images() const { return images_; }
  // Whether an image was asked for since the last call.
  bool take_thumbnail_request() { return std::exchange(thumbnail_wanted_, false); }
  // The status if it came after the last call.
  std::optional<ServerStatus> take_fresh_status();

 private:
  bool from_our_server(RunId server_run);

  const RunId agent_run_;
  RunId server_run_;
  bool server_alive_ = false;
  std::vector<RunId> former_;  // server runs that were replaced
  std::uint32_t newest_ = 0;   // sequence number of the newest patch taken
  std::optional<FrameId> credit_, acknowledged_;
  std::deque<MapPatch> patches_;
  std::optional<ServerStatus> status_;
  std::optional<AgentImages> images_;
  bool fresh_status_ = false, thumbnail_wanted_ = false;
};

// Values of messages that agents read: those that the inbox takes.
template <class Value>
concept ReadByAgents = requires(Inbox& inbox, Value value) {
  inbox.add(std::move(value));
};

}  // namespace coslam
