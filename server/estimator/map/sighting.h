// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "common/geometry/far_point.h"
#include "server/estimator/map/map.h"

// What cameras see of a thing at one instant, and where it is by that.
namespace coslam {

// What a camera sees of a point at one instant.
struct Seen {
  BoundTrack track;
  View view;  // at the instant of the set
};

inline constexpr double kMovingParallax_rad = 0.01;
// Many tracks do not live longer; by then it is told apart what does not follow any one thing.
inline constexpr double kSettled_s = 0.13;

// The i-th observation of a track, where its point is.
Sighting sighting(const MapCamera& camera, const ServerTrack& track, std::size_t i);
// The same as it would be at t_ns: interpolated, pose and pixel, when the camera took its image at another time. Empty
// without a pose in the camera's map.
std::optional<View> view_at(const MapCamera& camera, const ServerTrack& track, std::size_t i, TimeNs t_ns);

// Cameras among them.
int cameras_of(const std::vector<Seen>& seen);
// How far off a view may be.
double gate_px_of(const Map& map, const std::vector<Seen>& seen);

// Observations of a point in this very set, at its instant, of cameras with a pose in its map.
std::vector<Seen> seen_now(const Map& map, const MapPoint& p);

// The one place that observations of one instant by at least two cameras agree on.
std::optional<TriangulationResult> position_of(const Map& map, const std::vector<Seen>& seen, double min_parallax_rad);

// The direction of a track that has no point, by its views so far; empty when it may move, is too young to tell, or
// nothing is known of how far away things are around the camera.
std::optional<FarPoint> far_point_of(const Map& map, const MapCamera& camera, const ServerTrack& track);

struct MotionPosition {
  TriangulationResult at;
  int views = 0;
};
// Where the cameras with a pose in this map saw a moving point, by the poses of now.
std::optional<MotionPosition> position_of(const Map& map, MapId in, const MotionSample& sample);

}  // namespace coslam
