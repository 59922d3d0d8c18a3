// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "common/geometry/far_point.h"
#include "server/estimator/map/map.h"

// Observations of a thing by cameras at one instant, and its position by these.
namespace coslam {

// Observation of a point by a camera at one instant.
struct Seen {
  BoundTrack track;
  View view;  // view at the instant of the set
};

// Least parallax of views from which a known thing is positioned anew.
inline constexpr double kLeastParallax_rad = 0.01;
// Number of views, spread over a track's life, that stand for all of them.
inline constexpr std::size_t kViewsOfTrack = 6;
// Least noise that solutions of several poses believe of an observation: what is below comes of tracks alike.
inline constexpr double kLeastSigma_px = 0.3;
// Age at which a track is taken for a reliable one: most that follow no single thing have ended or shown it by then.
inline constexpr double kSettled_s = 0.13;

// Returns the i-th observation of a track, shifted to where its point is.
Sighting sighting(const MapCamera& camera, const ServerTrack& track, std::size_t i);
// Returns the i-th observation as it would be at t_ns: pose and pixel interpolated when the camera took its image at
// another time. Empty without a pose in the camera's map.
std::optional<View> view_at(const MapCamera& camera, const ServerTrack& track, std::size_t i, TimeNs t_ns);

// Number of different cameras.
int cameras_of(const std::vector<Seen>& seen);
// Largest distance of a view from a point's projection, in pixels.
double gate_px_of(const Map& map, const std::vector<Seen>& seen);

// Returns the observations of a point in this very set, at its instant, by cameras with a pose in its map.
std::vector<Seen> seen_now(const Map& map, const MapPoint& p);

// Triangulates observations of one instant by at least two cameras; empty when they do not agree on one place.
std::optional<TriangulationResult> position_of(const Map& map, const std::vector<Seen>& seen, double min_parallax_rad);

// Direction of a track that has no point, by its views so far; empty when it may move, is too young to tell, or the
// depth of the scene around the camera is unknown.
std::optional<FarPoint> far_point_of(const Map& map, const MapCamera& camera, const ServerTrack& track);

struct MotionPosition {
  TriangulationResult at;
  int views = 0;
};
// Triangulates a moving point from a sample, by the present poses of the cameras in this map.
std::optional<MotionPosition> position_of(const Map& map, MapId in, const MotionSample& sample);

}  // namespace coslam
