// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "common/base/ids.h"
#include "common/base/time.h"
#include "common/dataset/result.h"
#include "common/geometry/rigid3.h"

// Accuracy of map points against a world whose surfaces are known.
namespace coslam::eval {

struct SurfacePoint {
  Eigen::Vector3d position;  // truth frame
  double distance_m = 0;     // distance from the camera
  std::string body;          // body that it is on; empty: a thing that cannot move
  Eigen::Vector3d velocity_m_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d body_velocity_m_s = Eigen::Vector3d::Zero();  // mean over the body
  bool on_depth_edge = false;
};
// A corner on the outline of a thing belongs to the thing, but the ray through it may pass beside and show what is
// behind. distance_beside_m: that is seen so many pixels beside a spot; infinite where nothing is. Across a plane the
// inverse distance is nearly linear, so it is an edge where the two on either side do not have it between them.
bool is_on_depth_edge(double distance_m, const std::function<double(const Eigen::Vector2d& by_px)>& distance_beside_m);

// Finds the surface that an agent's pixel shows at a time; empty where that is not known.
using SurfaceAt =
    std::function<std::optional<SurfacePoint>(const std::string& agent, TimeNs t_ns, const Eigen::Vector2d& raw_px)>;

// Collects, point by point, the surface under the pixels that observed it. All observations of a static point show the
// same spot; where they do not, or most lie on an edge of depth, the point has no truth.
class StaticTruth {
 public:
  void add(PointId point, const SurfacePoint& seen);
  // Median of what was seen, of points seen at least twice, mostly off edges of depth, that scatter by less than 2 % of
  // their distance.
  std::unordered_map<PointId, Eigen::Vector3d> positions() const;
  std::size_t points() const { return seen_.size(); }

 private:
  std::unordered_map<PointId, std::vector<SurfacePoint>> seen_;
};

struct PointAccuracy {
  int count = 0;
  double error_median_m = 0, error_p90_m = 0;
  double nees_median = 0, nees_p90 = 0;  // honest covariances: 2.37 and 6.25, chi square with 3 degrees of freedom
  int nees_count = 0;                    // fewer than count where covariances are singular
  int without_truth = 0;                 // points that were seen, but scattered or on an edge of depth
};

// Static points against the truth by id: error e = truth_from_map * estimate - truth, NEES = e^T (s^2 R Sigma R^T)^-1
// e.
PointAccuracy accuracy_of(const std::vector<ResultPoint>& points,
                          const std::unordered_map<PointId, Eigen::Vector3d>& truth, const Similarity3& truth_from_map);

struct ErrorSpread {
  double median = 0, p90 = 0;
  int count = 0;
};
ErrorSpread spread_of(const std::vector<double>& errors);

}  // namespace coslam::eval
