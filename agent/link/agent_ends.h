// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "agent/link/reply_writers.h"
#include "common/wire/counters.h"
#include "common/wire/loop.h"
#include "common/wire/writers.h"

namespace coslam {

// Ends of an agent's link in the domain: participant, writers and readers.
struct AgentEnds {
  // Types that are written as they are, one writer each.
  using Plain = Writers<SelectedTypes<goes_up, Hello, TrackFrame, PatchReply, DescriptorReply>>;

  Participant participant;
  std::deque<Writer<idl::TrackFrame>> tracks;  // in turn
  ReplyEnds replies{participant};
  std::optional<Writer<idl::Hello>> hello;
  Plain plain{participant};  // after hello: the end of a status waits for the last word, before the sign of life
  Loop loop;                 // last: stops first

  AgentEnds(const WireConfig& config, const std::string& agent, std::shared_ptr<RejectionCounts> rejections,
            std::chrono::milliseconds tick, const std::function<void(AgentEnds&)>& on_tick)
      : participant(config, "coslam-agent " + agent, std::move(rejections)),
        loop(participant, "agent-link", tick, [this, on_tick] { on_tick(*this); }) {}

  // Both ways of every topic: where a word of discovery is lost, that takes seconds.
  bool whole() const {
    const auto found = [](const auto& writer) { return writer.readers() > 0; };
    return std::ranges::all_of(tracks, found) && found(replies) && found(*hello) &&
           found(plain.writer<idl::AgentStatus>()) && loop.writers<idl::MapPatch>() > 0;
  }

  LinkBytes bytes() const {
    LinkBytes sum;
    for (const TopicCounts& c : participant.counts()) {
      sum.up += c.sent_bytes;
      sum.down += c.received_bytes;
    }
    return sum;
  }
};

}  // namespace coslam
