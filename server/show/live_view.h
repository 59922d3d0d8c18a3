// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "server/fleet/link/server_link.h"
#include "server/show/map_teller.h"
#include "server/show/web/live_api.h"
#include "server/show/web/view_config.h"
#include "server/show/web/web_server.h"

namespace coslam {

// Shows a server at work on the web.
class LiveView {
 public:
  // Watches the loop from now on; it is not to run on after this has gone. others: who is told too; they outlive this.
  // Throws UserError when the port cannot be had.
  LiveView(const ViewConfig& config, ServerLoop& loop, const std::vector<PublicSink*>& others = {});

  // Images of agents come over this link, which outlives this.
  void look_by(ServerLink& link);

  // Where a browser finds it.
  std::string url() const { return web_.url(); }
  std::string url(const std::string& address) const { return web_.url(address); }

 private:
  LiveApi api_;
  WebServer web_;
  MapTeller teller_;  // last: it tells the others
};

}  // namespace coslam
