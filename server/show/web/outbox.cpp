// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/web/outbox.h"

#include <algorithm>
#include <utility>

namespace coslam {

bool Outbox::put_text(std::string text) {
  if (texts_.size() >= kMostTexts) return false;
  texts_.push_back(std::move(text));
  return true;
}

void Outbox::put_message(foxglove::SubscriptionId subscription, const MessagePtr& message) {
  const auto same = [&](const Item& item) { return item.body->channel == message->channel; };
  const std::size_t usual = message->octets.size() > kBig ? 1 : kMostOfChannel;
  const std::size_t most = std::max(usual, message->channel->keep);
  if (static_cast<std::size_t>(std::ranges::count_if(messages_, same)) >= most)
    drop(std::ranges::find_if(messages_, same));
  Item item{true, foxglove::message_head(subscription, message->t_ns), message};
  while (!messages_.empty() && bytes_ + item.bytes() > kMostBytes) drop(messages_.begin());
  bytes_ += item.bytes();
  messages_.push_back(std::move(item));
}

void Outbox::drop(const std::deque<Item>::iterator& item) {
  bytes_ -= item->bytes();
  messages_.erase(item);
  ++dropped_;
}

void Outbox::drop_all() {
  texts_.clear();
  time_.reset();
  messages_.clear();
  bytes_ = 0;
}

std::optional<Outbox::Item> Outbox::take() {
  if (!texts_.empty()) {
    Item item{false, std::move(texts_.front()), nullptr};
    texts_.pop_front();
    return item;
  }
  if (time_) return Item{true, foxglove::time_message(*std::exchange(time_, std::nullopt)), nullptr};
  if (messages_.empty()) return std::nullopt;
  Item item = std::move(messages_.front());
  messages_.pop_front();
  bytes_ -= item.bytes();
  return item;
}

}  // namespace coslam
