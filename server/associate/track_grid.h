// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "server/map/map.h"

// Which tracks of a camera lie where a point should appear: for the stages that search for known points in images.
namespace coslam {

// Tracks of one camera by place.
class TrackGrid {
 public:
  void add(const ServerTrack* t) { cells_[cell(t->seen.back().undistorted_px.cast<double>())].push_back(t); }
  template <class Visit>
  void near(const Eigen::Vector2d& px, double radius_px, Visit visit) const {
    const auto low = cell(px - Eigen::Vector2d::Constant(radius_px)),
               high = cell(px + Eigen::Vector2d::Constant(radius_px));
    for (int y = low.second; y <= high.second; ++y) {
      for (int x = low.first; x <= high.first; ++x) {
        const auto at = cells_.find({x, y});
        if (at == cells_.end()) continue;
        for (const ServerTrack* t : at->second) visit(t);
      }
    }
  }

 private:
  static constexpr double kCellPx = 16;
  static std::pair<int, int> cell(const Eigen::Vector2d& px) {
    return {static_cast<int>(std::floor(px.x() / kCellPx)), static_cast<int>(std::floor(px.y() / kCellPx))};
  }
  std::map<std::pair<int, int>, std::vector<const ServerTrack*>> cells_;
};

// Where a point projects, and how far around that it may be; empty far outside the image and when the point is too
// uncertain to be told from its neighbours.
struct SearchWindow {
  Eigen::Vector2d px;
  Eigen::Matrix2d covariance;  // of px by the point's own
  double radius_px = 0;
};

inline std::optional<SearchWindow> search_window(const CameraModel& camera, const Rigid3& cam_from_world,
                                                 const MapPoint& p, double gate_px, double theta) {
  constexpr double kMostPx = 40, kMargin = 0.3;  // margin: undistorted pixels may lie outside the image
  SearchWindow w;
  if (!project_world(camera, cam_from_world, p.position, &w.px)) return std::nullopt;
  if (w.px.x() < -kMargin * camera.width_px || w.px.x() > (1 + kMargin) * camera.width_px ||
      w.px.y() < -kMargin * camera.height_px || w.px.y() > (1 + kMargin) * camera.height_px) {
    return std::nullopt;
  }
  Eigen::Matrix<double, 2, 3> j;  // not before: most points are out of sight
  project_world(camera, cam_from_world, p.position, &w.px, &j);
  w.covariance = j * p.covariance * j.transpose();
  w.radius_px = theta * std::sqrt(w.covariance.trace() + gate_px * gate_px);
  return w.radius_px > kMostPx ? std::nullopt : std::optional(w);
}

// Static points seen lately, which cameras may find again.
inline std::vector<const MapPoint*> recent_static_points(const Map& map) {
  std::vector<const MapPoint*> out = map.recent_points();
  std::erase_if(out, [](const MapPoint* p) { return !p->rests(); });
  return out;
}

}  // namespace coslam
