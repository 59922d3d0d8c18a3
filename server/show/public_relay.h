// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

#include "server/fleet/link/server_link.h"
#include "server/show/publish/channel.h"

namespace coslam {

// Gives bridges what they hand on, over the link, while there are any: all but the image planes, which are for viewers.
class PublicRelay final : public PublicSink {
 public:
  // The link outlives it.
  explicit PublicRelay(ServerLink& link) : link_(link) {}

  void announce(const ChannelPtr&) override {}
  bool wants(const Channel& channel) const override {
    return wanted_ && channel.part.bits != PartSet(Part::kTracks).bits;
  }
  void put(const MessagePtr& message) override;
  PartSet parts() const override;
  // Comes at least once a second: soon enough to notice a bridge.
  void see(const Snapshot&) override { wanted_ = link_.public_wanted(); }

 private:
  ServerLink& link_;
  std::atomic<bool> wanted_{false};
};

}  // namespace coslam
