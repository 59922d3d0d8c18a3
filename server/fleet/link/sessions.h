// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "common/wire/codec.h"
#include "common/wire/loop.h"
#include "common/wire/track_codec.h"
#include "server/fleet/link/admission.h"
#include "server/fleet/link/frame_joiner.h"
#include "server/fleet/link/server_link.h"
#include "server/fleet/link/thumbnails.h"

namespace coslam {

// The common part of the server's ends of all links, whatever carries the messages: decodes, admits, joins, counts, and
// turns samples into events. Nothing of a run is delivered before the way back to it is open. Pure: time is an
// argument. Thread-compatible.
class Sessions {
 public:
  Sessions(std::chrono::milliseconds patience, RejectionCounts& rejections)
      : admission_(patience), rejections_(rejections) {}

  void receive(const idl::Hello& message, std::uint64_t bytes, Instant now);
  void receive(const idl::TrackFrame& message, std::uint64_t bytes, Instant now);
  void receive(const idl::PatchReply& message, std::uint64_t bytes, Instant now);
  void receive(const idl::DescriptorReply& message, std::uint64_t bytes, Instant now);
  void receive(const idl::AgentStatus& message, std::uint64_t bytes, Instant now);
  void receive(const idl::Thumbnail& message, std::uint64_t bytes, Instant now);
  void presence(RunId run, Presence presence);
  void tick(Instant now);

  // Runs that were admitted and wait for their way back; open() ends the wait and delivers the Hello.
  std::vector<RunId> waiting() const;
  void open(RunId run);
  std::vector<RunId> runs() const;
  bool said_ready(RunId run) const { return early_.contains(run); }  // told by a status
  bool knows(RunId run) const { return admission_.find(run) != nullptr; }

  void refuse(const Hello& hello, const std::string& reason);
  const std::vector<Refusal>& refused() const { return admission_.refused(); }

  std::vector<ServerEvent> take_events() { return std::exchange(events_, {}); }
  // Lock-step frames that came again since the last call: the frame or its answer was lost, or the server is slow.
  std::vector<std::pair<RunId, FrameId>> take_repeated() { return std::exchange(repeated_, {}); }

  // The run that is to be asked for a thumbnail now, because somebody looks; and the newest one.
  std::optional<RunId> look(const std::string& agent, Instant now);
  std::optional<Thumbnail> thumbnail(const std::string& agent, Instant now) const {
    return thumbnails_.newest(agent, now);
  }

  void count_down(RunId run, std::uint64_t bytes);
  void count_down_all(std::uint64_t bytes);  // sent to every agent
  LinkBytes bytes(const std::string& agent) const;
  std::uint64_t late_replies() const;

 private:
  struct Session {
    Hello hello;
    FrameJoiner joiner;
    TrackDecoder decoder;
    bool open = false;
    bool silent = false;
  };

  void settle();
  Session* admit_sample(const std::string& agent, RunId run, std::uint64_t bytes);
  void keep_early(AgentStatus status);
  template <class Reply>
  void receive_reply(Decoded<Reply> reply, std::uint64_t bytes, Instant now);
  void deliver_frames(Session& session, Instant now);
  void end(RunId run, Session& session);
  void note(std::optional<Rejection> reason);

  Admission admission_;
  RejectionCounts& rejections_;
  std::map<RunId, Session> sessions_;
  std::map<RunId, AgentStatus> early_;  // statuses that came before their run was open
  std::map<std::string, LinkBytes> bytes_;
  std::vector<ServerEvent> events_;
  Thumbnails thumbnails_;
  std::vector<std::pair<RunId, FrameId>> repeated_;
  std::uint64_t late_of_ended_ = 0;
};

}  // namespace coslam
