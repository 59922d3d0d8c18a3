// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <set>
#include <vector>

#include "common/model/moving_state.h"
#include "server/estimator/map/map.h"
#include "server/estimator/pipeline/stage.h"
#include "server/estimator/reports/objects_report.h"
#include "server/estimator/reports/scale_report.h"

namespace coslam {

// Writes the moving states that are published: one for each map in which something moves, after each frame set, and an
// empty one when that has ended.
class MovingWriter {
 public:
  explicit MovingWriter(RunId server_run) : server_run_(server_run) {}

  // Writes the states of all maps; in_metres: the maps whose scale is known.
  std::vector<MovingState> write(const Map& map, const std::vector<MovingObject>& objects,
                                 const std::set<MapId>& in_metres);

 private:
  RunId server_run_;
  std::set<MapId> moving_maps_;  // maps in which something moved at the last call
};

struct MovingStates {
  std::vector<MovingState> all;
};

struct AnnounceMoving {
  static constexpr std::string_view kName = "announce_moving";
  using Config = NoConfig<AnnounceMoving>;
  Config config;
  MovingStates run(const Map& map, const ServerRun& server, const ObjectsReport& objects, const ScaleReport& scale) {
    if (!writer) writer.emplace(server.id);
    return {writer->write(map, objects.list, scale.in_metres)};
  }
  std::optional<MovingWriter> writer = {};
};

}  // namespace coslam
