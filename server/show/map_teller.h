// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/base/metrics.h"
#include "server/app/server_observer.h"
#include "server/show/path_watch.h"
#include "server/show/publication.h"
#include "server/show/publish/watch.h"

namespace coslam {

// Tells the public of a server at work, by sinks.
class MapTeller final : public ServerObserver {
 public:
  // Watches the loop from now on; it is not to run on after this has gone. The sinks outlive this.
  MapTeller(ServerLoop& loop, std::vector<PublicSink*> sinks);

  void after_set(const FrameSet& set, const ServerLoop& loop) override;
  void in_between(const ServerLoop& loop) override;
  void finishing(const ServerLoop& loop) override;
  void finished(const ServerLoop& loop) override;

 private:
  void tell(Snapshot snapshot);
  LoopFacts facts(const ServerLoop& loop) const;

  StageTimes times_;
  MapWatch watch_;
  PathWatch paths_;
  Publication publication_;
};

}  // namespace coslam
