// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <utility>

#include "server/estimator/map/map.h"

namespace coslam {

class PointsByPlace;

// What an image patch of a track without one is good for, where few get through: two cameras are bound to one point
// only when patches of both tracks are there.
enum class PatchWorth : std::uint8_t {
  kDecides,  // a point with a patch should appear where the track is, or the other way round
  kHelps,    // the same, but neither has one
  kAlone,    // no point of others should appear there
};

// Of the tracks of a frame set.
class PatchWorths {
 public:
  PatchWorths() = default;
  PatchWorths(const Map& map, const FrameSet& set);

  // Less is more: worth, then how far from the track the point should appear, squared, in sigmas.
  using Rank = std::pair<PatchWorth, double>;
  Rank of(CameraId camera, TrackId track) const;

 private:
  void collect(const Map& map, const MapCamera& camera, const PointsByPlace& points);
  void note(CameraId camera, TrackId track, const Rank& rank);

  std::map<std::pair<CameraId, TrackId>, Rank> ranks_;
};

}  // namespace coslam
