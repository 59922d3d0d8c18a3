// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>

#include "common/flow/background_job.h"
#include "server/estimator/map_server.h"

namespace coslam {

// Estimates how uncertain the paths of a map are while it grows: from time to time, in a background thread, so that it
// takes little of the processor. Called from the map's thread.
class PathWatch {
 public:
  // Begins an estimate when it is due, and takes the result of the last one; to be called after each frame set.
  void look(const MapServer& server, std::chrono::steady_clock::time_point now);
  // Newest estimate for a camera in the largest map; empty: none yet.
  std::optional<PathError> path_error(CameraId camera) const;

 private:
  struct Found {
    PathErrors paths;
    std::chrono::steady_clock::duration took{};
  };
  std::chrono::steady_clock::time_point due_;
  std::chrono::steady_clock::duration planning_{};
  PathErrors paths_;
  std::optional<BackgroundJob<Found>> beside_;  // created at the first look
};

}  // namespace coslam
