// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "server/app/server_loop.h"
#include "server/show/live_view.h"
#include "server/show/log_sink.h"
#include "server/show/snapshot_observer.h"

namespace coslam {

// Observers of a map server in this process, as long as it lives: the log, as of a server of its own, and the web where
// that is wanted.
class RunTold {
 public:
  RunTold(const ViewConfig& view, ServerLoop& loop);

 private:
  LogSink log_;
  std::optional<LiveView> view_;
  std::optional<SnapshotObserver> teller_;
};

}  // namespace coslam
