// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "agent/link/agent_link.h"
#include "agent/link/reply_writers.h"
#include "common/base/time.h"
#include "common/wire/codec.h"

namespace coslam {

// Replies of an agent on their way: in parts, which are written as the limits allow. In lock-step there are no limits,
// and the newest parts are kept to be written again. Thread-compatible.
class ReplyQueue {
 public:
  // Takes the replies that leave with one frame; those of the frame before are not written again any more.
  void put(const std::optional<PatchReply>& patches, const std::optional<DescriptorReply>& descriptors, Instant now);
  void write(ReplyEnds& ends, Instant now);  // as much as one frame leaves room for
  void write_again(ReplyEnds& ends) const;   // lock-step: all parts of the newest replies
  bool patches_wait() const { return !patches_.empty(); }
  bool descriptors_wait() const { return !descriptors_.empty(); }

  // Sets the limits from now on; true when the link has become narrow.
  bool limit(const ReplyLimits& limits);
  RepliesWaiting waiting() const { return {patches_wait(), descriptors_wait(), sent_bytes_}; }

 private:
  template <class Reply, class Message>
  void put_parts(const Reply& reply, std::deque<Message>& waiting, std::vector<Message>& newest);
  template <class Message>
  void write_waiting(std::deque<Message>& waiting, ReplyWriters<Message>& writers);

  std::deque<idl::PatchReply> patches_;
  std::deque<idl::DescriptorReply> descriptors_;
  std::vector<idl::PatchReply> newest_patches_;
  std::vector<idl::DescriptorReply> newest_descriptors_;
  std::optional<ReplyLimits> limits_;  // none in lock-step
  double room_ = 0, sent_bytes_ = 0;
  Instant described_{};  // time of the newest descriptors
};

}  // namespace coslam
