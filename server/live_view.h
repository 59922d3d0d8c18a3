// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/base/metrics.h"
#include "server/publication.h"
#include "server/publish/watch.h"
#include "server/server_observer.h"
#include "server/web/live_api.h"
#include "server/web/view_config.h"
#include "server/web/web_server.h"

namespace coslam {

// Shows a server at work on the web.
class LiveView final : public ServerObserver {
 public:
  // Watches the loop from now on; it is not to run on after this has gone. Throws UserError when the port cannot be
  // had.
  LiveView(const ViewConfig& config, ServerLoop& loop);

  // Where a browser finds it.
  std::string url() const { return web_.url(); }

  void after_set(const FrameSet& set, const ServerLoop& loop) override;
  void in_between(const ServerLoop& loop) override;
  void finishing(const ServerLoop& loop) override;
  void finished(const ServerLoop& loop) override;

 private:
  LoopFacts facts(const ServerLoop& loop) const;
  void tell(Snapshot snapshot);

  StageTimes times_;
  MapWatch watch_;
  LiveApi api_;
  WebServer web_;
  Publication publication_;  // last: it tells the others
};

}  // namespace coslam
