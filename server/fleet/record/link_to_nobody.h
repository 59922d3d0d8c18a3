// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/fleet/link/server_link.h"

namespace coslam {

// The server's end of links whose agents are recorded: what is sent to them goes nowhere.
class LinkToNobody : public ServerLink {
 public:
  bool at_work() const override { return true; }
  void send(const ServerMessage&) override {}
  void send_status(const ServerStatus&) override {}
  void refuse(const Hello&, const std::string&) override {}
  LinkBytes bytes(const std::string&) const override { return {}; }
  ServerLinkCounts counts() const override { return {}; }
  const RejectionCounts& rejections() const override { return rejections_; }

 private:
  RejectionCounts rejections_;
};

}  // namespace coslam
