// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <utility>

#include "server/estimator/map/map.h"

namespace coslam {

class PointsByPlace;

// Value of an image patch for a track that has none, where only few can be sent: two cameras are bound to one point
// only when both tracks have patches.
enum class PatchWorth : std::uint8_t {
  kDecides,  // the track is near where a point should appear, and the track or the point has a patch already
  kHelps,    // the track is near where a point should appear, and neither has a patch
  kAlone,    // no point of other cameras should appear near the track
};

// Patch worths of the tracks of a frame set.
class PatchWorths {
 public:
  PatchWorths() = default;
  PatchWorths(const Map& map, const FrameSet& set);

  // Rank of a track, best first: worth, then the squared distance from the track to where the point should appear, in
  // sigmas.
  using Rank = std::pair<PatchWorth, double>;
  Rank rank_of(CameraId camera, TrackId track) const;

 private:
  void collect(const Map& map, const MapCamera& camera, const PointsByPlace& points);
  void note(CameraId camera, TrackId track, const Rank& rank);

  std::map<std::pair<CameraId, TrackId>, Rank> ranks_;
};

}  // namespace coslam
