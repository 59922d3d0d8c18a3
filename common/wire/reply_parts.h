// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "common/model/track_frame.h"
#include "common/wire/codec.h"
#include "common/wire/counters.h"

// Answers to requests travel in parts that fit one datagram each: on a narrow link they go between the frames, and the
// loss of one costs no other.
namespace coslam {

std::vector<PatchReply> in_parts(const PatchReply& reply);
std::vector<DescriptorReply> in_parts(const DescriptorReply& reply);

// The answer that these are the parts of, at least one, in any order. Rejected unless all are there, of one sender and
// one frame.
template <class Reply>
Decoded<Reply> in_one(std::vector<Reply> parts);

// Puts the parts of the answers of one agent run together, whatever their order. Of a type of answer at most `bound`
// are held; the oldest makes room. Thread-compatible.
template <class Reply>
class PartJoiner {
 public:
  explicit PartJoiner(std::size_t bound) : bound_(bound) {}

  // Adds a part from decode(). The result names a reason when the part was refused, or another one was dropped for it.
  std::optional<Rejection> add(Reply part);
  bool has(FrameId frame) const;             // whether all parts are there
  std::optional<Reply> take(FrameId frame);  // takes the whole reply; empty when parts are missing
  std::optional<FrameId> oldest_complete() const;

 private:
  struct Gathered {
    FrameId frame;
    std::vector<std::optional<Reply>> parts;
    std::size_t missing = 0;
  };
  const std::size_t bound_;
  std::deque<Gathered> gathered_;  // in order of arrival
};

extern template Decoded<PatchReply> in_one(std::vector<PatchReply> parts);
extern template Decoded<DescriptorReply> in_one(std::vector<DescriptorReply> parts);
extern template class PartJoiner<PatchReply>;
extern template class PartJoiner<DescriptorReply>;

}  // namespace coslam
