// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/link/frame_joiner.h"

#include <algorithm>
#include <utility>

namespace coslam {
namespace {

// Far more than ever wait in good order; what a faulty agent sends beyond them is turned down.
constexpr std::size_t kMaxFrames = 64;
constexpr std::size_t kMaxPatchReplies = 16;
constexpr std::size_t kMaxDescriptorReplies = 4;

template <class Reply>
bool has(const std::deque<Reply>& replies, FrameId frame) {
  return std::ranges::any_of(replies, [frame](const Reply& r) { return r.frame == frame; });
}

}  // namespace

std::optional<Rejection> FrameJoiner::add(TrackFrame frame, Instant now) {
  const auto at = std::ranges::lower_bound(held_, frame.frame, {}, [](const Held& h) { return h.frame.frame; });
  if (passed(frame.frame) || (at != held_.end() && at->frame.frame == frame.frame)) return Rejection::kDuplicate;
  if (held_.size() == kMaxFrames) return Rejection::kOverflow;
  held_.insert(at, {std::move(frame), now});
  return std::nullopt;
}

template <class Reply>
std::optional<Rejection> FrameJoiner::keep(std::deque<Reply>& replies, Reply reply, std::size_t bound) {
  // In lock-step a frame never left without its replies, so these came twice.
  const bool again = pacing_ == Pacing::kLockstep && passed(reply.frame);
  if (again || has(replies, reply.frame)) return Rejection::kDuplicate;
  std::optional<Rejection> overflow;
  if (replies.size() == bound) {
    replies.pop_front();
    overflow = Rejection::kOverflow;
  }
  replies.push_back(std::move(reply));
  return overflow;
}

std::optional<Rejection> FrameJoiner::add(PatchReply reply) {
  return keep(patches_, std::move(reply), kMaxPatchReplies);
}

std::optional<Rejection> FrameJoiner::add(DescriptorReply reply) {
  return keep(descriptors_, std::move(reply), kMaxDescriptorReplies);
}

bool FrameJoiner::complete(const TrackFrame& frame) const {
  return (frame.patches_sent == 0 || has(patches_, frame.frame)) &&
         (!frame.descriptors_sent || has(descriptors_, frame.frame));
}

bool FrameJoiner::waited_enough(const Held& held, Instant now) const {
  if (now == Instant::max()) return true;
  return pacing_ == Pacing::kLive && (now - held.since >= kPatience || held_.size() == kMaxFrames);
}

// The frame's own reply, or else the oldest one that missed its frame.
template <class Reply>
std::optional<Reply> FrameJoiner::claim(std::deque<Reply>& replies, FrameId frame) {
  auto found = std::ranges::find(replies, frame, &Reply::frame);
  if (found == replies.end()) {
    found = std::ranges::min_element(replies, {}, &Reply::frame);
    if (found == replies.end() || found->frame > frame) return std::nullopt;
    ++late_replies_;
  }
  std::optional<Reply> reply(std::move(*found));
  replies.erase(found);
  return reply;
}

std::optional<JoinedFrame> FrameJoiner::pop(Instant now) {
  if (held_.empty()) return std::nullopt;
  if (!complete(held_.front().frame) && !waited_enough(held_.front(), now)) return std::nullopt;
  JoinedFrame joined{std::move(held_.front().frame), {}, {}};
  held_.pop_front();
  last_ = joined.frame.frame;
  joined.patches = claim(patches_, *last_);
  joined.descriptors = claim(descriptors_, *last_);
  return joined;
}

}  // namespace coslam
