// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "server/keep/explain/event_log.h"

// The words of an event.
namespace coslam::explain {

// Three significant digits, whole numbers whole; NaN: "?".
std::string number(double value);
// Seconds of the run, to the millisecond.
std::string seconds(const EventLog& log, TimeNs t_ns);
// The reason with its figures, to go on after what happened.
std::string reason(const Event& event);
std::string name(PointId point);
std::string name(MapId map);
std::string name(const EventLog& log, CameraId camera);
std::string name(const EventLog& log, const TrackKey& track);
inline TrackKey track_of(const Event& e) { return {e.camera.value_or(CameraId()), e.track}; }
// "on trial", "static", "moving".
std::string words(PointPhase phase);
// Describes an event of a whole map: it moved or became part of another.
std::string map_sentence(const Event& event);
std::string miss_sentence(const std::string& subject, const Event& event);

}  // namespace coslam::explain
