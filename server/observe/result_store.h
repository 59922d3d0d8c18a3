// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/dataset/result.h"
#include "common/dataset/trajectory.h"
#include "server/map_server.h"
#include "server/observe/event_store.h"

namespace coslam {

// Writes the RESULT folder: what belongs to an instant as it happens, the rest at the end.
class ResultStore {
 public:
  // Makes the folder. Throws UserError when it cannot be written.
  explicit ResultStore(const std::filesystem::path& folder, const EventsConfig& events = {});

  // After each step of the server.
  void record(const FrameSet& set, const MapServer& server);
  // After the server's own finish: trajectories, points and the report (see make_report). Throws UserError, e.g. for a
  // full disk.
  void finish(const MapServer& server, const nlohmann::ordered_json& report);

 private:
  void record_live(const CameraFrame& cf, const MapServer& server);
  void write_trajectories(const MapServer& server);
  void record_tracks(const CameraFrame& cf, const MapServer& server);
  void record_groups(const FrameSet& set, const MapServer& server);
  void record_objects(const FrameSet& set, const MapServer& server);
  void write_objects(const std::map<PointId, MovingPath>& paths);

  struct SeenObject {
    TimeNs t_ns = 0;
    ObjectId id;
    std::vector<PointId> members;
  };

  ResultFolder folder_;
  // Poses as the agents published them, by camera and the map whose frame they are in.
  std::map<CameraId, std::map<MapId, Trajectory>> live_;
  std::map<CameraId, std::vector<std::pair<MapEpoch, MapId>>>
      told_;  // which map an agent was told of, from each epoch on
  std::map<std::string, std::unique_ptr<TrackWriter>> tracks_;
  GroupWriter groups_;
  DynamicWriter dynamic_;
  ObjectWriter object_rows_;
  EventStore events_;
  std::vector<SeenObject> objects_;
  std::vector<std::vector<CameraId>> last_groups_;
};

}  // namespace coslam
