// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "server/estimator/associate/track_grid.h"
#include "server/estimator/map/map.h"

namespace coslam {

// Points by place, so that what is near a camera's tracks is found without a look at every point.
class PointsByPlace {
 public:
  // Ascending ids.
  explicit PointsByPlace(const std::vector<const MapPoint*>& points);

  // All of the camera's map that its newest pose has in the image or up to search_margin_px() and the largest radius
  // beside it, and for which near() of the grid would visit a track within reach; and a few others. Ascending.
  std::vector<const MapPoint*> near_tracks(const MapCamera& camera, const TrackGrid& grid,
                                           const SearchRadius& radius) const;

 private:
  struct Place {
    Eigen::Vector3f position = Eigen::Vector3f::Zero();
    float variance = 0;    // of all directions together
    std::uint32_t of = 0;  // points_
  };
  struct Box {
    MapId map;
    Eigen::Vector3d low, high;
    std::size_t first, last;  // of the arrays below, one beyond the last
  };
  void box(std::span<const Place> places, MapId map);
  static Place place_of(const MapPoint& point, std::uint32_t of);
  void hold(const Place& place);

  std::vector<const MapPoint*> points_;  // ascending ids
  std::vector<Box> boxes_;
  // Of each place, those of a box together.
  std::vector<std::uint32_t> of_;
  Eigen::ArrayXf x_, y_, z_, variance_;
  float furthest_ = 0;  // from the origin, along an axis
};

}  // namespace coslam
