// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/model/thumbnail.h"
#include "server/show/snapshot_observer.h"
#include "server/show/web/live_api.h"
#include "server/show/web/view_config.h"
#include "server/show/web/web_server.h"

namespace coslam {

// Shows a server at work on the web, from the moment at which the server's loop has its observer.
class LiveView {
 public:
  // Finds the present image of a camera by the name of its agent.
  using ThumbnailSource = std::function<std::optional<Thumbnail>(const std::string& agent)>;

  // more_sinks: further receivers; they outlive this. Throws UserError when the port cannot be had.
  LiveView(const ViewConfig& config, const MapServer& server, const std::vector<PublicSink*>& more_sinks = {},
           ThumbnailSource thumbnails = {});

  SetObserver& observer() { return teller_; }

  // Address of the page for a browser.
  std::string url() const { return web_.url(); }
  std::string url(const std::string& address) const { return web_.url(address); }

 private:
  LiveApi api_;
  WebServer web_;
  SnapshotObserver teller_;  // last: it tells the others
};

}  // namespace coslam
