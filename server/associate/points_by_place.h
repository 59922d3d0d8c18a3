// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "server/associate/track_grid.h"
#include "server/map/map.h"

namespace coslam {

// Points by place, so that what is near a camera's tracks is found without a look at every point.
class PointsByPlace {
 public:
  // Ascending ids.
  explicit PointsByPlace(const std::vector<const MapPoint*>& points);

  // All of the camera's map that its newest pose has in the image or up to search_margin_px() and the largest radius
  // beside it, and that near() of the grid would visit a track for; and a few others. Ascending.
  std::vector<const MapPoint*> near_tracks(const MapCamera& camera, const TrackGrid& grid,
                                           const SearchRadius& radius) const;
  // A point was moved since.
  void moved(const MapPoint& point);

 private:
  struct Place {
    const MapPoint* point;
    Eigen::Vector3d position;
    double variance;  // of all directions together
  };
  struct Box {
    MapId map;
    Eigen::Vector3d low, high;
    std::size_t first, last;  // of places_, one beyond the last
  };
  void split(std::size_t first, std::size_t last);

  std::vector<Place> places_;  // those of a box together
  std::vector<Box> boxes_;
};

}  // namespace coslam
