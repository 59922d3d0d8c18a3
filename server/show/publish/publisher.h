// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "server/show/publish/channel.h"
#include "server/show/publish/names.h"
#include "server/show/publish/rates.h"
#include "server/show/publish/snapshot.h"

namespace coslam {

// Events that somebody who comes later is told.
inline constexpr std::size_t kKeptEvents = 256;

// Makes messages of snapshots: those that somebody wants. Pure. Thread-compatible.
class Publisher {
 public:
  Publisher();

  // All channels so far; more agents bring more, none is removed.
  const std::vector<ChannelPtr>& channels() const { return channels_; }

  using Announce = std::function<void(const ChannelPtr&)>;  // a new channel, before its first message
  using Wants = std::function<bool(const Channel&)>;
  using Put = std::function<void(const MessagePtr&)>;
  void encode(const Snapshot& snapshot, const Announce& announce, const Wants& wants, const Put& put);

  // Rates at the newest state that was encoded.
  const Rates& rates() const { return rates_; }
  RosNames& names() { return names_; }

 private:
  struct OfAgent {
    ChannelPtr pose, odom, path, key_frames, tracks;
  };
  const OfAgent& of_agent(const std::string& agent, const Announce& announce);
  ChannelPtr add(Channel channel);

  std::vector<ChannelPtr> channels_;
  ChannelPtr tf_, points_, moving_, objects_, detections_, state_, events_;
  std::map<std::string, OfAgent> agents_;
  RosNames names_;
  Rates rates_;
};

}  // namespace coslam
