// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/link/sessions.h"

#include <algorithm>

namespace coslam {
namespace {

constexpr std::size_t kMaxEarly = idl::MAX_AGENTS;

}  // namespace

void Sessions::note(std::optional<Rejection> reason) {
  if (reason) rejections_.add(*reason);
}

void Sessions::receive(const idl::Hello& message, std::uint64_t bytes, Instant now) {
  auto hello = decode(message);
  if (!hello) return note(hello.rejection());
  admission_.hello(*hello, now);
  if (hello->protocol != kProtocolVersion) note(Rejection::kWrongProtocol);
  settle();
  if (knows(hello->agent_run)) bytes_[hello->agent].up += bytes;
}

// Brings the sessions in line with what was admitted and refused.
void Sessions::settle() {
  for (Hello& hello : admission_.take_admitted()) {
    // A run that was gone keeps its joiner, which knows what was delivered already, and its decoder.
    sessions_.try_emplace(hello.agent_run, Session{hello, FrameJoiner(hello.pacing), {}});
  }
  std::erase_if(sessions_, [this](const auto& entry) {
    if (knows(entry.first)) return false;
    late_of_ended_ += entry.second.joiner.late_replies();
    return true;
  });
}

Sessions::Session* Sessions::admit_sample(const std::string& agent, RunId run, std::uint64_t bytes) {
  const auto reason = admission_.check(agent, run);
  settle();
  const auto found = sessions_.find(run);
  if (reason || found == sessions_.end() || !found->second.open) {
    note(reason.value_or(Rejection::kUnknownAgent));
    return nullptr;
  }
  found->second.silent = false;
  bytes_[agent].up += bytes;
  return &found->second;
}

void Sessions::receive(const idl::TrackFrame& message, std::uint64_t bytes, Instant now) {
  const RunId run(message.agent_run());
  const FrameId number(message.frame());
  const auto header = decode_header(message);
  if (!header) return note(header.rejection());
  Session* session = admit_sample(message.agent().to_string(), run, bytes);
  if (session == nullptr) return;
  auto frame = session->decoder.decode(message);
  if (!frame) return note(frame.rejection());
  const auto reason = session->joiner.add(std::move(*frame), now);
  note(reason);
  if (reason == Rejection::kDuplicate && session->hello.pacing == Pacing::kLockstep)
    repeated_.emplace_back(run, number);
  deliver_frames(*session, now);
}

// Statuses and hellos take separate ways: a status may be ahead of its hello.
void Sessions::keep_early(AgentStatus status) {
  if (admission_.check(status.agent, status.agent_run) == Rejection::kWrongRun) return note(Rejection::kWrongRun);
  settle();
  if (early_.size() < kMaxEarly || early_.contains(status.agent_run)) early_[status.agent_run] = std::move(status);
}

template <class Reply>
void Sessions::receive_reply(Decoded<Reply> reply, std::uint64_t bytes, Instant now) {
  if (!reply) return note(reply.rejection());
  Session* session = admit_sample(reply->agent, reply->agent_run, bytes);
  if (session == nullptr) return;
  note(session->joiner.add(std::move(*reply)));
  deliver_frames(*session, now);
}

void Sessions::receive(const idl::PatchReply& message, std::uint64_t bytes, Instant now) {
  receive_reply(decode(message), bytes, now);
}

void Sessions::receive(const idl::DescriptorReply& message, std::uint64_t bytes, Instant now) {
  receive_reply(decode(message), bytes, now);
}

void Sessions::receive(const idl::AgentStatus& message, std::uint64_t bytes, Instant now) {
  auto status = decode(message);
  if (!status) return note(status.rejection());
  status->exchange.arrived_ns = std::chrono::nanoseconds(now.time_since_epoch()).count();
  const auto found = sessions_.find(status->agent_run);
  if (found == sessions_.end() || !found->second.open) return keep_early(std::move(*status));
  if (admit_sample(status->agent, status->agent_run, bytes) != nullptr) events_.emplace_back(std::move(*status));
}

void Sessions::receive(const idl::Thumbnail& message, std::uint64_t bytes, Instant now) {
  auto thumbnail = decode(message);
  if (!thumbnail) return note(thumbnail.rejection());
  if (admit_sample(thumbnail->agent, thumbnail->agent_run, bytes) != nullptr)
    thumbnails_.add(std::move(*thumbnail), now);
}

std::optional<RunId> Sessions::look(const std::string& agent, Instant now) {
  const auto open = std::ranges::find_if(sessions_, [&](const auto& entry) {
    const Session& session = entry.second;
    return session.open && session.hello.agent == agent;
  });
  if (open == sessions_.end() || !thumbnails_.look(agent, now)) return std::nullopt;
  return open->first;
}

void Sessions::deliver_frames(Session& session, Instant now) {
  while (auto joined = session.joiner.pop(now)) events_.emplace_back(std::move(*joined));
}

void Sessions::presence(RunId run, Presence presence) {
  const auto found = sessions_.find(run);
  if (presence == Presence::kAlive) admission_.alive(run);
  if (presence == Presence::kAlive && found != sessions_.end()) found->second.silent = false;
  if (presence == Presence::kSilent) {
    if (found != sessions_.end() && found->second.open && !std::exchange(found->second.silent, true)) {
      events_.emplace_back(AgentSilent{found->second.hello.agent, run});
    }
    admission_.silent(run);
  }
  if (presence == Presence::kGone) {
    if (found != sessions_.end()) end(run, found->second);
    admission_.note_gone(run);
    early_.erase(run);
  }
  settle();
}

void Sessions::end(RunId run, Session& session) {
  deliver_frames(session, Instant::max());  // no reply will come any more
  if (session.open) events_.emplace_back(AgentGone{session.hello.agent, run});
  session.open = false;
}

void Sessions::tick(Instant now) {
  admission_.tick(now);
  thumbnails_.tick(now);
  settle();
  for (auto& [run, session] : sessions_) {
    if (session.open) deliver_frames(session, now);
  }
}

std::vector<RunId> Sessions::waiting() const {
  std::vector<RunId> runs;
  for (const auto& [run, session] : sessions_) {
    if (!session.open && admission_.present(run)) runs.push_back(run);
  }
  return runs;
}

std::vector<RunId> Sessions::runs() const {
  std::vector<RunId> runs;
  for (const auto& [run, session] : sessions_) runs.push_back(run);
  return runs;
}

void Sessions::open(RunId run) {
  const auto found = sessions_.find(run);
  if (found == sessions_.end() || found->second.open) return;
  found->second.open = true;
  found->second.silent = false;
  events_.emplace_back(found->second.hello);
  if (auto early = early_.extract(run)) events_.emplace_back(std::move(early.mapped()));
}

void Sessions::refuse(const Hello& hello, const std::string& reason) {
  admission_.refuse(hello.agent, hello.agent_run, reason);
  settle();
}

void Sessions::count_down(RunId run, std::uint64_t bytes) {
  if (const Hello* hello = admission_.find(run)) bytes_[hello->agent].down += bytes;
}

void Sessions::count_down_all(std::uint64_t bytes) {
  for (const auto& [run, session] : sessions_) {
    if (session.open) bytes_[session.hello.agent].down += bytes;
  }
}

LinkBytes Sessions::bytes(const std::string& agent) const {
  const auto found = bytes_.find(agent);
  return found == bytes_.end() ? LinkBytes{} : found->second;
}

std::uint64_t Sessions::late_replies() const {
  std::uint64_t total = late_of_ended_;
  for (const auto& [run, session] : sessions_) total += session.joiner.late_replies();
  return total;
}

}  // namespace coslam
