// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>
#include <utility>

#include "common/base/time.h"
#include "common/model/session.h"
#include "common/model/track_frame.h"
#include "common/wire/counters.h"
#include "common/wire/reply_parts.h"
#include "server/fleet/link/server_link.h"

namespace coslam {

// Puts the frames of one agent run together with the replies that travelled apart from them, and puts them in order. A
// frame waits for the replies it announces: in lock-step as long as it takes, live for `patience` at most; then it goes
// without them, and they ride with a later one. Where frames overtake each other, one after a gap waits about as long
// as that takes, a quarter of a second at most. Pure: time is an argument. Thread-compatible.
class FrameJoiner {
 public:
  static constexpr std::chrono::milliseconds kPatience{100};

  explicit FrameJoiner(Pacing pacing) : pacing_(pacing) {}

  // Takes a message; the order of arrival does not matter. The result names a reason when it was refused.
  std::optional<Rejection> add(TrackFrame frame, Instant now);
  std::optional<Rejection> add(PatchReply part);
  std::optional<Rejection> add(DescriptorReply part);

  // The next frame that is complete, or has waited long enough; frames only ascend.
  std::optional<JoinedFrame> pop(Instant now);

  std::uint64_t late_replies() const { return late_replies_; }

 private:
  struct Held {
    TrackFrame frame;
    Instant held_since;
  };

  bool passed(FrameId frame) const { return last_ && frame <= *last_; }
  bool complete(const TrackFrame& frame) const;
  bool waited_enough(const Held& held, Instant now) const;
  bool may_be_overtaken(const Held& held, Instant now) const;
  void note_overtaken(FrameId frame, Instant now);
  template <class Reply>
  std::optional<Rejection> keep(PartJoiner<Reply>& replies, Reply part);
  template <class Reply>
  std::optional<Reply> claim(PartJoiner<Reply>& replies, FrameId frame);

  const Pacing pacing_;
  std::deque<Held> held_;  // ascending
  // Far more than ever wait in good order; what a faulty agent sends beyond them is turned down.
  PartJoiner<PatchReply> patches_{16};
  PartJoiner<DescriptorReply> descriptors_{4};
  std::optional<FrameId> last_;  // newest that was popped
  // Live: how long a frame waits for one before it. Nothing while frames come in order.
  std::chrono::duration<double> patience_{0};
  std::deque<std::pair<FrameId, Instant>> popped_;  // lately, with the time of arrival
  std::uint64_t late_replies_ = 0;
};

}  // namespace coslam
