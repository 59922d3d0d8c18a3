// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/show/publish/channel.h"

namespace coslam {

// Says in the server's log what happens to cameras, groups and maps. Who comes and goes the server's loop says itself.
class LogSink final : public PublicSink {
 public:
  void announce(const ChannelPtr&) override {}
  bool wants(const Channel&) const override { return false; }
  void put(const MessagePtr&) override {}
  PartSet parts() const override { return {}; }
  void see(const Snapshot& snapshot) override;
};

}  // namespace coslam
