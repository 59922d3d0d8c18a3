// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/link/reply_queue.h"

#include <algorithm>

#include "common/wire/reply_parts.h"

namespace coslam {

template <class Reply, class Message>
void ReplyQueue::put_parts(const Reply& reply, std::deque<Message>& waiting, std::vector<Message>& newest) {
  for (const Reply& part : in_parts(reply)) {
    waiting.push_back(encode(part));
    if (!limits_) newest.push_back(waiting.back());
  }
}

void ReplyQueue::put(const std::optional<PatchReply>& patches, const std::optional<DescriptorReply>& descriptors,
                     Instant now) {
  newest_patches_.clear();
  newest_descriptors_.clear();
  if (patches) put_parts(*patches, patches_, newest_patches_);
  if (!descriptors) return;
  put_parts(*descriptors, descriptors_, newest_descriptors_);
  described_ = now;
}

// Descriptors first: they are rare, and where maps have not met everything hangs on them. On a narrow link they would
// keep patches waiting for seconds, which take little room and are asked for where they tell something. Descriptors
// of long ago are left: few of their tracks are there still.
void ReplyQueue::write(ReplyEnds& ends, Instant now) {
  constexpr double kUnlimited = 1e12, kMostLeft = 1500;  // bytes that were not used last time
  constexpr std::chrono::milliseconds kStale{2500};
  room_ = limits_ ? std::min(room_, kMostLeft) + limits_->bytes_a_frame : kUnlimited;
  if (now - described_ > kStale) descriptors_.clear();
  if (limits_ && limits_->narrow_link) write_waiting(patches_, ends.patches);
  write_waiting(descriptors_, ends.descriptors);
  write_waiting(patches_, ends.patches);
}

template <class Message>
void ReplyQueue::write_waiting(std::deque<Message>& waiting, ReplyWriters<Message>& writers) {
  Writer<Message>& writer = limits_ && !limits_->narrow_link ? writers.soon : writers.usual;
  for (; !waiting.empty() && room_ > 0; waiting.pop_front()) {
    if (limits_ && sent_bytes_ >= limits_->up_to_bytes) return;
    const auto bytes = static_cast<double>(writer.write(waiting.front()));
    room_ -= bytes;
    sent_bytes_ += bytes;
  }
}

void ReplyQueue::write_again(ReplyEnds& ends) const {
  for (const auto& part : newest_patches_) ends.patches.usual.write(part);
  for (const auto& part : newest_descriptors_) ends.descriptors.usual.write(part);
}

bool ReplyQueue::limit(const ReplyLimits& limits) {
  const bool was_narrow = limits_ && limits_->narrow_link;
  limits_ = limits;
  return limits.narrow_link && !was_narrow;
}

}  // namespace coslam
