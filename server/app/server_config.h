// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <thread>

#include "server/estimator/map_pipeline.h"
#include "server/fleet/sync/frame_set_sync.h"
#include "server/keep/map_keeper.h"
#include "server/keep/observe/event_store.h"

// Keys of server.yaml below `server` (see common/config/config.h). Each is described beside its struct, with unit and
// bounds. Where the paper names a threshold, its name and value are used.
namespace coslam {

struct ServerConfig {
  int threads = 0;
  MapServerConfig map;
  SyncConfig sync;
  EventsConfig events;
  KeepConfig map_file;
};

template <class V>
void describe(V& v, ServerConfig& c) {
  v.field("threads", c.threads, {0, 256},
          "that share in what is done camera by camera for a frame set; 0: half as many as there are cores, 8 at most");
  describe(v, c.map);
  v.section("sync", c.sync);
  v.section("events", c.events);
  v.section("map_file", c.map_file);
}

// Number of threads that share in a frame set, as configured or by the cores of this machine.
inline int threads_of(const ServerConfig& config) {
  constexpr unsigned kMost = 8;
  if (config.threads > 0) return config.threads;
  return static_cast<int>(std::clamp(std::thread::hardware_concurrency() / 2, 1U, kMost));
}

}  // namespace coslam
