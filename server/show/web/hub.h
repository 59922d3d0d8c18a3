// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "server/show/publish/channel.h"
#include "server/show/web/foxglove.h"

namespace coslam {

// One client as the hub sees it. Nothing here may wait or call back.
class HubClient {
 public:
  HubClient() = default;
  virtual ~HubClient() = default;
  HubClient(const HubClient&) = delete;
  HubClient& operator=(const HubClient&) = delete;

  virtual void send_text(std::string text) = 0;
  virtual void send_message(foxglove::SubscriptionId subscription, const MessagePtr& message) = 0;
  virtual void send_time(TimeNs t_ns) = 0;
};

// Keeps track of which client reads which channel. Thread-compatible.
class Hub {
 public:
  static constexpr std::size_t kMostSubscriptions = 5000;  // limit for one client

  explicit Hub(std::string session) : session_(std::move(session)) {}

  void announce(const ChannelPtr& channel);
  void put(const MessagePtr& message);

  void join(HubClient& client);
  void leave(HubClient& client);
  // A text of the client's. False: it speaks another protocol.
  bool hear(HubClient& client, std::string_view text);

  std::size_t clients() const { return clients_.size(); }
  // Topics that at least one client reads.
  struct Wanted {
    std::set<std::string> topics;
    PartSet parts;  // parts of a snapshot that their messages are made of
  };
  Wanted wanted() const;

 private:
  struct Known {
    ChannelPtr channel;
    std::deque<MessagePtr> newest;
    std::map<HubClient*, foxglove::SubscriptionId> readers;
  };
  void subscribe(HubClient& client, foxglove::SubscriptionId id, foxglove::ChannelId channel);
  void unsubscribe(HubClient& client, foxglove::SubscriptionId id);

  std::string session_;
  std::vector<Known> channels_;  // id - 1
  std::map<std::string, std::size_t> by_topic_;
  std::map<HubClient*, std::map<foxglove::SubscriptionId, std::size_t>> clients_;  // to indices of channels
  TimeNs newest_ns_ = 0;
};

}  // namespace coslam
