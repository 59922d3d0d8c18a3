// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/link/frame_joiner.h"

#include <algorithm>
#include <utility>

namespace coslam {
namespace {

constexpr std::size_t kMaxFrames = 64;  // as in the header
constexpr std::chrono::duration<double> kLongestWait{0.25};
constexpr double kForget = 0.998;  // a frame: half of it in ten seconds

}  // namespace

std::optional<Rejection> FrameJoiner::add(TrackFrame frame, Instant now) {
  const auto at = std::ranges::lower_bound(held_, frame.frame, {}, [](const Held& h) { return h.frame.frame; });
  if (passed(frame.frame)) note_overtaken(frame.frame, now);
  if (passed(frame.frame) || (at != held_.end() && at->frame.frame == frame.frame)) return Rejection::kDuplicate;
  if (held_.size() == kMaxFrames) return Rejection::kOverflow;
  held_.insert(at, {std::move(frame), now});
  return std::nullopt;
}

template <class Reply>
std::optional<Rejection> FrameJoiner::keep(PartJoiner<Reply>& replies, Reply part) {
  // In lock-step a frame never left without its replies, so these came twice.
  if (pacing_ == Pacing::kLockstep && passed(part.frame)) return Rejection::kDuplicate;
  return replies.add(std::move(part));
}

std::optional<Rejection> FrameJoiner::add(PatchReply part) { return keep(patches_, std::move(part)); }
std::optional<Rejection> FrameJoiner::add(DescriptorReply part) { return keep(descriptors_, std::move(part)); }

bool FrameJoiner::complete(const TrackFrame& frame) const {
  return (frame.patches_sent == 0 || patches_.has(frame.frame)) &&
         (frame.descriptors_sent != DescriptorsSent::kWithFrame || descriptors_.has(frame.frame));
}

bool FrameJoiner::waited_enough(const Held& held, Instant now) const {
  if (now == Instant::max()) return true;
  return pacing_ == Pacing::kLive && (now - held.held_since >= kPatience || held_.size() == kMaxFrames);
}

bool FrameJoiner::may_be_overtaken(const Held& held, Instant now) const {
  const bool gap = last_ && held.frame.frame.value > last_->value + 1;
  return pacing_ == Pacing::kLive && gap && now - held.held_since < patience_ && now != Instant::max();
}

void FrameJoiner::note_overtaken(FrameId frame, Instant now) {
  const auto overtaker = std::ranges::find_if(popped_, [&](const auto& p) { return p.first >= frame; });
  if (overtaker == popped_.end() || overtaker->first == frame) return;  // of long ago, or a second time
  const std::chrono::duration<double> late = 1.2 * (now - overtaker->second);
  patience_ = std::min(std::max(patience_, late), kLongestWait);
}

// The frame's own reply, or else the oldest one that missed its frame.
template <class Reply>
std::optional<Reply> FrameJoiner::claim(PartJoiner<Reply>& replies, FrameId frame) {
  if (replies.has(frame)) return replies.take(frame);
  const auto late = replies.oldest_complete();
  if (!late || *late > frame) return std::nullopt;
  ++late_replies_;
  return replies.take(*late);
}

std::optional<JoinedFrame> FrameJoiner::pop(Instant now) {
  if (held_.empty()) return std::nullopt;
  if (!complete(held_.front().frame) && !waited_enough(held_.front(), now)) return std::nullopt;
  if (may_be_overtaken(held_.front(), now)) return std::nullopt;
  JoinedFrame joined{std::move(held_.front().frame), {}, {}};
  const bool time_passes = held_.front().held_since != Instant{};
  if (pacing_ == Pacing::kLive && time_passes) joined.arrived = held_.front().held_since;
  popped_.emplace_back(joined.frame.frame, held_.front().held_since);
  if (popped_.size() > kMaxFrames) popped_.pop_front();
  held_.pop_front();
  last_ = joined.frame.frame;
  patience_ *= kForget;
  joined.patches = claim(patches_, *last_);
  joined.descriptors = claim(descriptors_, *last_);
  return joined;
}

}  // namespace coslam
