// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/time.h"
#include "server/show/publish/channel.h"

// The Foxglove WebSocket protocol, as far as a server that is only read has to speak it: JSON texts, and binary
// messages whose first octet says what they are.
namespace coslam::foxglove {

// The sub-protocol to answer with, of those that a client offers in its header; empty: it speaks none of ours.
std::string_view chosen_protocol(std::string_view offered);

using ChannelId = std::uint32_t;
using SubscriptionId = std::uint32_t;  // given by the client

std::string server_info(std::string_view session);
struct Advertised {
  ChannelId id;
  const Channel* channel;
};
std::string advertise(const std::vector<Advertised>& channels);
enum class Level : std::uint8_t { kInfo, kWarning, kError };
std::string status(Level level, std::string_view text);

// Header of a message, which its octets follow; time_message() is complete.
std::string message_head(SubscriptionId subscription, TimeNs t_ns);
std::string time_message(TimeNs t_ns);

struct Request {
  enum class Kind : std::uint8_t { kSubscribe, kUnsubscribe, kOther };
  Kind kind = Kind::kOther;
  std::string op;
  std::vector<std::pair<SubscriptionId, ChannelId>> subscribe;
  std::vector<SubscriptionId> unsubscribe;
};
// Parses a client's text; empty when it is not of the protocol.
std::optional<Request> parse_request(std::string_view text);

}  // namespace coslam::foxglove
