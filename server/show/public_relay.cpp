// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/public_relay.h"

#include <string>

namespace coslam {

PartSet PublicRelay::parts() const {
  if (!wanted_) return {};
  return PartSet(kAllParts.bits & ~PartSet(Part::kTracks).bits);
}

void PublicRelay::put(const MessagePtr& message) {
  const Channel& channel = *message->channel;
  const bool json = channel.encoding == Encoding::kJson;
  link_.send(PublicSample{channel.topic, json ? kJsonType : std::string(channel.type), message->t_ns, message->octets});
}

}  // namespace coslam
