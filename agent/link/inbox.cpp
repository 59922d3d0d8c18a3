// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/link/inbox.h"

#include <algorithm>
#include <utility>

namespace coslam {

constexpr std::size_t kMaxFormer = 64;

bool Inbox::from_our_server(RunId run) {
  if (run == server_run_) return true;
  if (server_alive_) return false;
  if (std::ranges::find(former_, run) != former_.end()) return false;
  if (server_run_.value != 0) former_.push_back(server_run_);
  if (former_.size() > kMaxFormer) former_.erase(former_.begin());
  server_run_ = run;
  newest_ = 0;
  acknowledged_.reset();
  patches_.clear();
  return true;
}

std::optional<Rejection> Inbox::add(MapPatch patch) {
  if (patch.agent_run != agent_run_ || !from_our_server(patch.server_run)) return Rejection::kWrongRun;
  if (patch.sequence <= newest_) return Rejection::kDuplicate;
  newest_ = patch.sequence;
  acknowledged_ = std::max(acknowledged_.value_or(FrameId()), patch.after_frame);
  patches_.push_back(std::move(patch));
  if (patches_.size() <= kCapacity) return std::nullopt;
  patches_.pop_front();
  return Rejection::kOverflow;
}

std::optional<Rejection> Inbox::add(ServerStatus status) {
  if (!from_our_server(status.server_run)) return Rejection::kWrongRun;
  status_ = std::move(status);
  fresh_status_ = true;
  return std::nullopt;
}

std::optional<Rejection> Inbox::add(AgentImages images) {
  if (images.agent_run != agent_run_ || !from_our_server(images.server_run)) return Rejection::kWrongRun;
  images_ = std::move(images);
  return std::nullopt;
}

std::optional<Rejection> Inbox::add(const ThumbnailRequest& request) {
  if (request.agent_run != agent_run_ || !from_our_server(request.server_run)) return Rejection::kWrongRun;
  thumbnail_wanted_ = true;
  return std::nullopt;
}

std::optional<MapPatch> Inbox::pop() {
  if (patches_.empty()) return std::nullopt;
  std::optional<MapPatch> patch(std::move(patches_.front()));
  patches_.pop_front();
  credit_ = credit_ ? std::max(*credit_, patch->after_frame) : patch->after_frame;
  return patch;
}

std::optional<ServerStatus> Inbox::take_fresh_status() {
  return std::exchange(fresh_status_, false) ? status_ : std::nullopt;
}

}  // namespace coslam
