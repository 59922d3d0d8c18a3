// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/mcap_sink.h"

#include <string>

namespace coslam {

void McapSink::announce(const ChannelPtr& channel) {
  const bool json = channel->encoding == Encoding::kJson;
  const std::uint16_t schema =
      writer_.add_schema(std::string(channel->type), json ? "jsonschema" : "ros2msg", std::string(channel->schema));
  channels_[channel.get()] = writer_.add_channel(channel->topic, json ? "json" : "cdr", schema);
}

void McapSink::put(const MessagePtr& message) {
  writer_.write(channels_.at(message->channel.get()), message->t_ns, message->octets);
}

}  // namespace coslam
