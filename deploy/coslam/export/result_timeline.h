// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/dataset/result.h"
#include "common/dataset/trajectory.h"
#include "server/show/publish/snapshot.h"

namespace coslam::exporting {

// Contents of a result by the time at which each was to be told.
struct ResultTimeline {
  // Poses at one instant, each agent once.
  struct Instant {
    TimeNs t_ns = 0;
    std::vector<PublicPose> poses;
  };
  struct Agent {
    std::string name;
    RunId run;
    CameraModel camera;
    double frame_ms = 0, rate_hz = 0;
    std::vector<std::pair<MapId, Trajectory>> paths;  // path in each map that it has poses in
    TimeNs last_ns = 0;                               // time of its last pose
    std::optional<PathVerdict> path;                  // verdict on its path in the end
  };

  MapId main;
  std::size_t maps = 0;
  bool scale_known = false;
  double ms_per_set = 0;
  std::vector<Agent> agents;
  std::vector<Instant> instants;
  std::vector<std::pair<TimeNs, ros::StaticPoint>> points;  // points and the times when they were first seen
  std::map<TimeNs, PublicMoving> moving;
  std::map<TimeNs, std::vector<PublicImage>> images;
  std::vector<PublicEvent> events;
  std::vector<ResultGroupRow> groups;
};

// Reads the whole result. Throws UserError.
ResultTimeline timeline_of(const ResultContents& contents);

}  // namespace coslam::exporting
