// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "common/wire/participant.h"

namespace coslam {

// Two writers of one type of reply. On a link that carries everything, what was lost is sent again soon: most tracks
// live for a second or two.
template <class Message>
struct ReplyWriters {
  explicit ReplyWriters(Participant& participant) : usual(participant), soon(participant, {}, Repeat::kSoon) {}
  int readers() const { return std::min(usual.readers(), soon.readers()); }
  Writer<Message> usual, soon;
};

// Writers of all replies.
struct ReplyEnds {
  explicit ReplyEnds(Participant& participant) : patches(participant), descriptors(participant) {}
  int readers() const { return std::min(patches.readers(), descriptors.readers()); }
  void forget_soon() {
    patches.soon.forget();
    descriptors.soon.forget();
  }
  ReplyWriters<idl::PatchReply> patches;
  ReplyWriters<idl::DescriptorReply> descriptors;
};

}  // namespace coslam
