// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/keep/explain/sentence.h"

#include <cmath>
#include <cstdio>

namespace coslam::explain {

std::string number(double value) {
  if (std::isnan(value)) return "?";
  constexpr double kWhole = 1e9;
  char text[32];
  const bool whole = value == std::round(value) && std::abs(value) < kWhole;
  std::snprintf(text, sizeof text, whole ? "%.0f" : "%.3g", value);
  return text;
}

std::string seconds(const EventLog& log, TimeNs t_ns) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f s", log.seconds(t_ns));
  return text;
}

std::string reason(const Event& e) {
  std::string text(text_of(e.why).clause);
  for (const std::size_t i : {0U, 1U}) {
    const std::string_view place = i == 0 ? "{a}" : "{b}";
    const std::size_t at = text.find(place);
    if (at != std::string::npos) text.replace(at, place.size(), number(e.figures.at(i)));
  }
  return text;
}

std::string name(PointId point) { return "point " + std::to_string(point.value); }
std::string name(MapId map) { return "map " + std::to_string(map.value); }
std::string name(const EventLog& log, CameraId camera) { return log.name_of(camera); }

std::string name(const EventLog& log, const TrackKey& track) {
  return log.name_of(track.camera) + "/" + std::to_string(track.track.value);
}

std::string words(PointPhase phase) { return phase == PointPhase::kTrial ? "on trial" : std::string(name_of(phase)); }

std::string map_sentence(const Event& e) {
  if (e.kind == EventKind::kMapMerged)
    return "Map " + std::to_string(e.from.value) + " became part of " + name(e.map) + " " + reason(e);
  return "Its " + name(e.map) + (e.why == Why::kAdjusted ? " was changed " : " was moved ") + reason(e);
}

std::string miss_sentence(const std::string& subject, const Event& e) {
  if (e.why == Why::kBehindCamera) return subject + " missed the gate: behind its camera";
  return subject + " missed the gate by " + number(e.figures[1]) + " sigma";
}

}  // namespace coslam::explain
