// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/keep/explain/event_log.h"

// Lives of points, tracks and cameras, told from the events. Pure.
namespace coslam::explain {

// An event in the life of a thing.
struct Entry {
  TimeNs t_ns = 0;
  std::string text;  // a sentence without its end
  // Aspect that the entry is about ("phase", "cam0/12"), and its value from here on ("static"); empty: no aspect.
  std::string aspect, now;
  // Entries with the same one that follow each other are told as one: "misses of cam0/12".
  std::string fold;
  std::optional<double> sigmas;  // distance in standard deviations; of folded entries the largest is printed
  At at = 0;
  bool in_text = true;  // false: it only sets the state from here on
};

struct Life {
  std::string subject;  // "point 12"
  std::vector<Entry> entries;
  bool alive = true;  // at the end of the file
  PointId last;       // the point that a point became part of in the end, or itself
};

// Life of a point; empty when no event names it.
std::optional<Life> life_of_point(const EventLog& log, PointId point);
std::optional<Life> life_of_track(const EventLog& log, const TrackKey& track);
std::optional<Life> life_of_camera(const EventLog& log, CameraId camera);

// The whole life, a line each, repeated events told as one.
std::string life_text(const EventLog& log, const Life& life);
// State of the thing at an instant (of the log's clock, not of the run), and the reason.
std::string told_at(const EventLog& log, const Life& life, TimeNs t_ns);

}  // namespace coslam::explain
