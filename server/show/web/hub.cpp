// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/web/hub.h"

namespace coslam {

void Hub::announce(const ChannelPtr& channel) {
  if (!by_topic_.try_emplace(channel->topic, channels_.size()).second) return;
  channels_.push_back({channel, {}, {}});
  const std::string text = foxglove::advertise({{static_cast<foxglove::ChannelId>(channels_.size()), channel.get()}});
  for (const auto& [client, subscriptions] : clients_) client->send_text(text);
}

void Hub::put(const MessagePtr& message) {
  const auto at = by_topic_.find(message->channel->topic);
  if (at == by_topic_.end()) return;
  Known& known = channels_[at->second];
  if (message->t_ns > newest_ns_) {
    newest_ns_ = message->t_ns;
    for (const auto& [client, subscriptions] : clients_) {
      if (!subscriptions.empty()) client->send_time(newest_ns_);
    }
  }
  for (const auto& [client, id] : known.readers) client->send_message(id, message);
  known.newest.push_back(message);
  while (known.newest.size() > known.channel->keep) known.newest.pop_front();
}

void Hub::join(HubClient& client) {
  clients_[&client];
  client.send_text(foxglove::server_info(session_));
  std::vector<foxglove::Advertised> all;
  for (std::size_t i = 0; i < channels_.size(); ++i)
    all.push_back({static_cast<foxglove::ChannelId>(i + 1), channels_[i].channel.get()});
  client.send_text(foxglove::advertise(all));
}

void Hub::leave(HubClient& client) {
  clients_.erase(&client);
  for (Known& known : channels_) known.readers.erase(&client);
}

bool Hub::hear(HubClient& client, std::string_view text) {
  const auto request = foxglove::parse_request(text);
  if (!request) return false;
  for (const auto& [id, channel] : request->subscribe) subscribe(client, id, channel);
  for (const auto id : request->unsubscribe) unsubscribe(client, id);
  if (request->kind == foxglove::Request::Kind::kOther) {
    constexpr std::size_t kMostOfOp = 40;
    client.send_text(foxglove::status(foxglove::Level::kWarning, "this server can only be read: it does nothing on '" +
                                                                     request->op.substr(0, kMostOfOp) + "'"));
  }
  return true;
}

void Hub::subscribe(HubClient& client, foxglove::SubscriptionId id, foxglove::ChannelId channel) {
  auto& subscriptions = clients_[&client];
  const auto refuse = [&](const std::string& why) {
    client.send_text(foxglove::status(foxglove::Level::kError, "subscription " + std::to_string(id) + ": " + why));
  };
  if (channel == 0 || channel > channels_.size()) return refuse("there is no channel " + std::to_string(channel));
  if (subscriptions.contains(id)) return refuse("it is there already");
  if (subscriptions.size() >= kMostSubscriptions) return refuse("there are too many");
  Known& known = channels_[channel - 1];
  if (!known.readers.try_emplace(&client, id).second)
    return refuse("channel " + std::to_string(channel) + " has another one of this client");
  subscriptions[id] = channel - 1;
  for (const MessagePtr& message : known.newest) client.send_message(id, message);
}

void Hub::unsubscribe(HubClient& client, foxglove::SubscriptionId id) {
  auto& subscriptions = clients_[&client];
  const auto at = subscriptions.find(id);
  if (at == subscriptions.end()) return;
  channels_[at->second].readers.erase(&client);
  subscriptions.erase(at);
}

Hub::Wanted Hub::wanted() const {
  Wanted out;
  for (const Known& known : channels_) {
    if (known.readers.empty()) continue;
    out.topics.insert(known.channel->topic);
    out.parts |= known.channel->part;
  }
  return out;
}

}  // namespace coslam
