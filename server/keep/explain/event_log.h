// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "server/estimator/map/journal.h"

// The events of events.csv, indexed by the points, tracks, cameras and maps they concern.
namespace coslam::explain {

// Index into EventLog::events.
using At = std::size_t;

struct TrackKey {
  CameraId camera;
  TrackId track;
  friend auto operator<=>(const TrackKey&, const TrackKey&) = default;
};

struct EventLog {
  // End of the file: the end of the run, the size limit, or none: the run goes on or was cut off.
  enum class End : std::uint8_t { kRunIsOver, kFull, kNone };

  std::vector<Event> events;         // figures that the file does not hold are NaN
  std::vector<std::string> cameras;  // names, by CameraId: in the order of their first events
  End end = End::kNone;
  TimeNs start_ns = 0;  // start of the run: texts count times from there
  TimeNs end_ns = 0;    // time of the newest line
  // Ascending.
  std::unordered_map<PointId, std::vector<At>> of_point;  // includes fusions in which the point is the other one
  std::map<TrackKey, std::vector<At>> of_track;
  std::map<CameraId, std::vector<At>> of_camera;  // no events of its tracks
  std::vector<At> of_maps;

  void add(const Event& event);
  CameraId camera_named(std::string_view name);
  const std::string& name_of(CameraId camera) const { return cameras[camera.value]; }
  double seconds(TimeNs t_ns) const { return to_seconds(t_ns - start_ns); }
};

// Throws UserError: file and line.
EventLog read_event_log(const std::filesystem::path& file);

}  // namespace coslam::explain
