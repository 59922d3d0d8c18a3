// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/base/metrics.h"
#include "server/keep/set_observer.h"
#include "server/show/path_watch.h"
#include "server/show/publish/watch.h"
#include "server/show/publish_thread.h"

namespace coslam {

// Tells the public of a server at work, by sinks.
class SnapshotObserver final : public SetObserver {
 public:
  // The sinks outlive this.
  SnapshotObserver(const MapServer& server, std::vector<PublicSink*> sinks);

  bool wants_journal() const override { return true; }
  void after_set(const SetOutcome& outcome, const ServerView& view) override;
  void idle(const ServerView& view) override;
  void ending(const ServerView& view, const nlohmann::ordered_json& report) override;
  void ended(const ServerView& view, const nlohmann::ordered_json& report) override { ending(view, report); }

 private:
  void tell(Snapshot snapshot);
  LoopFacts facts(const ServerView& view) const;

  StageTimes times_;
  MapWatch watch_;
  PathWatch paths_;
  PublishThread publication_;
};

}  // namespace coslam
