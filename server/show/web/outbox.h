// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "server/show/publish/channel.h"
#include "server/show/web/foxglove.h"

namespace coslam {

// Queue of messages for one client; its bound limits what a slow client costs. When it is full the oldest messages of
// the same channel are dropped first, since they are outdated. Thread-compatible.
class Outbox {
 public:
  static constexpr std::size_t kMostBytes = 8 << 20;  // but for one message that is larger
  static constexpr std::size_t kBig = 64 << 10;       // size above which only the newest message of a channel waits
  static constexpr std::size_t kMostOfChannel = 16, kMostTexts = 64;

  struct Item {
    bool binary = false;
    std::string head;
    MessagePtr body;  // octets that follow; null: none
    std::size_t bytes() const { return head.size() + (body ? body->octets.size() : 0); }
  };

  // Queues a text; false: the client asks for more answers than it reads.
  bool put_text(std::string text);
  void put_message(foxglove::SubscriptionId subscription, const MessagePtr& message);
  // The newest time alone matters.
  void put_time(TimeNs t_ns) { time_ = t_ns; }
  void drop_all();

  std::optional<Item> take();
  std::size_t bytes() const { return bytes_; }
  std::uint64_t dropped() const { return dropped_; }

 private:
  void drop(const std::deque<Item>::iterator& item);

  std::deque<std::string> texts_;  // go first
  std::optional<TimeNs> time_;
  std::deque<Item> messages_;
  std::size_t bytes_ = 0;  // size of the messages
  std::uint64_t dropped_ = 0;
};

}  // namespace coslam
