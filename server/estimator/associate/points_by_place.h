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

// Spatial index of points, which finds those near a camera's tracks without a look at every point.
class PointsByPlace {
 public:
  // Takes points in ascending order of ids.
  explicit PointsByPlace(const std::vector<const MapPoint*>& points);

  // Returns the points of the camera's map that its newest pose projects into the image, or up to search_margin_px()
  // and the largest radius beside it, and for which near() of the grid would visit a track within reach; and a few
  // others. Sorted by id.
  std::vector<const MapPoint*> near_tracks(const MapCamera& camera, const TrackGrid& grid,
                                           const SearchRadius& radius) const;

 private:
  struct Place {
    Eigen::Vector3f position = Eigen::Vector3f::Zero();
    float variance = 0;       // trace of the covariance
    std::uint32_t index = 0;  // index into points_
  };
  struct Box {
    MapId map;
    Eigen::Vector3d low, high;
    std::size_t first, last;  // range in the arrays below, last exclusive
  };
  void box(std::span<const Place> places, MapId map);
  static Place place_of(const MapPoint& point, std::uint32_t index);
  void hold(const Place& place);

  std::vector<const MapPoint*> points_;  // sorted by id
  std::vector<Box> boxes_;
  // One entry per place in each array, places of one box together.
  std::vector<std::uint32_t> indices_;
  Eigen::ArrayXf x_, y_, z_, variance_;
  float furthest_ = 0;  // largest distance from the origin, along an axis
};

}  // namespace coslam
