// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/keep/explain/event_log.h"

#include <algorithm>
#include <limits>
#include <optional>

#include "common/base/error.h"
#include "common/dataset/event_file.h"

namespace coslam::explain {
namespace {

constexpr double kUtc_s =
    1e8;  // no replay plays for three years: such stamps are UTC, and the run began with the first

// An event names what it is about.
bool is_whole(const Event& e) {
  switch (e.kind) {
    case EventKind::kPointMade:
    case EventKind::kPointBecame:
    case EventKind::kPointRemoved:
      return e.point != PointId();
    case EventKind::kPointFused:
      return e.point != PointId() && e.other != PointId() && e.point != e.other;
    case EventKind::kTrackBound:
      return e.camera && e.point != PointId();
    case EventKind::kMapStarted:
    case EventKind::kMapMerged:
    case EventKind::kMapMoved:
      return true;
    default:
      return e.camera.has_value();
  }
}

// Empty for names that this program does not know, and for events of nothing.
std::optional<Event> event_of(const EventRow& row, EventLog* log) {
  const auto kind = kind_of(row.kind);
  const auto why = why_of(row.why);
  if (!kind || !why) return std::nullopt;
  const auto to = state_of(*kind, row.to);
  if (!to) return std::nullopt;
  Event e;
  e.set = row.set;
  e.t_ns = row.t_ns;
  e.kind = *kind;
  e.why = *why;
  e.map = row.map;
  e.from = row.from;
  e.point = row.point;
  e.other = row.other;
  if (!row.camera.empty()) e.camera = log->camera_named(row.camera);
  e.track = row.track;
  e.to = *to;
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  e.figures = {row.a.value_or(kNone), row.b.value_or(kNone)};
  return is_whole(e) ? std::optional(e) : std::nullopt;
}

bool is_of_map(EventKind kind) { return kind >= EventKind::kMapStarted; }

}  // namespace

CameraId EventLog::camera_named(std::string_view name) {
  const auto at = std::ranges::find(cameras, name);
  const CameraId id(static_cast<std::uint16_t>(at - cameras.begin()));
  if (at == cameras.end()) cameras.emplace_back(name);
  return id;
}

void EventLog::add(const Event& e) {
  const At at = events.size();
  if (at == 0 && to_seconds(e.t_ns) > kUtc_s) start_ns = e.t_ns;
  end_ns = e.t_ns;
  events.push_back(e);
  if (is_of_map(e.kind)) of_maps.push_back(at);
  if (e.point != PointId()) of_point[e.point].push_back(at);
  if (e.other != PointId()) of_point[e.other].push_back(at);
  if (!e.camera) return;
  if (e.track != TrackId()) {
    of_track[{*e.camera, e.track}].push_back(at);
  } else {
    of_camera[*e.camera].push_back(at);
  }
}

EventLog read_event_log(const std::filesystem::path& file) {
  EventLog log;
  for_each_event_row(file, [&](const EventRow& row) {
    if (row.kind == kEventsEnd) {
      log.end = row.why == "file_is_full" ? EventLog::End::kFull : EventLog::End::kRunIsOver;
      log.end_ns = row.t_ns;
      return true;
    }
    const auto event = event_of(row, &log);
    if (!event || log.end != EventLog::End::kNone) return false;
    log.add(*event);
    return true;
  });
  return log;
}

}  // namespace coslam::explain
