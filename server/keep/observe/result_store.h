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
#include "server/estimator/map_server.h"
#include "server/keep/observe/event_store.h"
#include "server/keep/observe/result_past.h"
#include "server/keep/observe/track_store.h"

namespace coslam {

// Writes the RESULT folder: what belongs to an instant as it happens, the rest at the end.
class ResultStore {
 public:
  // Makes the folder. Throws UserError when it cannot be written, or holds a run already.
  explicit ResultStore(const std::filesystem::path& folder, const EventsConfig& events = {});

  // Takes what leaves the server's memory, in the order in which it left; to be called before record() of the same
  // step.
  void take(const PastPart& past);
  // Records a step of the server, after it. A write error is logged once for each file.
  void record(const FrameSet& set, const MapServer& server);
  // The whole result as it stands: paths, points and the report (see make_report) of all maps. Each file takes the
  // place of the one before in one step. Throws UserError, one sentence, when some could not be written; all others
  // are.
  void write(const MapServer& server, const nlohmann::ordered_json& report);
  // Like write(), for the last time, after the server's own finish.
  void finish(const MapServer& server, const nlohmann::ordered_json& report);

 private:
  class Attempts;
  void record_live(const CameraFrame& cf, const MapServer& server);
  void record_tracks(const CameraFrame& cf, const MapServer& server);
  void record_groups(const FrameSet& set, const MapServer& server);
  void record_objects(const FrameSet& set, const MapServer& server);
  TrackStore* tracks_of(const std::string& agent);  // null: its file cannot be made
  void say_problems();

  void write_paths(const MapServer& server, Attempts& attempts);
  void check_streams(bool last, Attempts& attempts);
  void write_maps(const MapServer& server, const nlohmann::ordered_json& report, Attempts& attempts);
  void write_map(const MapServer& server, MapId map, const ResultFolder& folder, Attempts& attempts);
  void write_moving(const MapServer& server, MapId map, const ResultFolder& folder, Attempts& attempts) const;
  Trajectory live_of(CameraId camera, MapId map) const;

  ResultFolder folder_;
  // Poses as the agents published them, by camera and the map whose frame they are in.
  std::map<CameraId, std::map<MapId, Trajectory>> live_;
  std::map<CameraId, std::vector<std::pair<MapEpoch, MapId>>>
      announced_;  // map that an agent was told to be in, from each epoch on
  std::map<std::string, std::unique_ptr<TrackStore>> tracks_;
  std::vector<std::string> not_made_;  // problems with the track files that could not be made
  GroupWriter groups_;
  EventStore events_;
  std::vector<SeenObject> objects_;
  ResultPast past_;  // earlier data that is no longer in memory
  std::vector<std::vector<CameraId>> last_groups_;
};

}  // namespace coslam
