// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/eval/points.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "deploy/coslam/eval/statistics.h"

namespace coslam::eval {
namespace {

Eigen::Vector3d median_position(const std::vector<SurfacePoint>& seen) {
  Eigen::Vector3d median;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    values.reserve(seen.size());
    for (const SurfacePoint& p : seen) values.push_back(p.position[axis]);
    median[axis] = percentile(std::move(values), 50);
  }
  return median;
}

// Distances are taken one by one: a point may be near to one camera and far from another.
bool scatters(const std::vector<SurfacePoint>& seen, const Eigen::Vector3d& center) {
  constexpr double kMaxScatter = 0.02;
  return std::any_of(seen.begin(), seen.end(),
                     [&](const SurfacePoint& p) { return (p.position - center).norm() > kMaxScatter * p.distance_m; });
}

bool mostly_on_edges(const std::vector<SurfacePoint>& seen) {
  return 2 * std::ranges::count_if(seen, &SurfacePoint::on_depth_edge) > std::ssize(seen);
}

}  // namespace

bool is_on_depth_edge(double distance_m, const std::function<double(const Eigen::Vector2d& by_px)>& distance_beside_m) {
  constexpr double kReach_px = 2;      // as far as corners are from the edges that make them
  constexpr double kLeastStep = 0.02;  // of the inverse distance
  const auto bends_along = [&](const Eigen::Vector2d& by_px) {
    const double bend = distance_m / distance_beside_m(by_px) + distance_m / distance_beside_m(-by_px) - 2;
    return std::abs(bend) > kLeastStep;
  };
  return bends_along({kReach_px, 0}) || bends_along({0, kReach_px});
}

void StaticTruth::add(PointId point, const SurfacePoint& seen) { seen_[point].push_back(seen); }

std::unordered_map<PointId, Eigen::Vector3d> StaticTruth::positions() const {
  std::unordered_map<PointId, Eigen::Vector3d> positions;
  for (const auto& [point, seen] : seen_) {
    const Eigen::Vector3d center = median_position(seen);
    if (seen.size() >= 2 && !mostly_on_edges(seen) && !scatters(seen, center)) positions.emplace(point, center);
  }
  return positions;
}

PointAccuracy accuracy_of(const std::vector<ResultPoint>& points,
                          const std::unordered_map<PointId, Eigen::Vector3d>& truth,
                          const Similarity3& truth_from_map) {
  const Eigen::Matrix3d linear = truth_from_map.scale * truth_from_map.rotation.toRotationMatrix();
  std::vector<double> errors, nees;
  for (const ResultPoint& point : points) {
    const auto true_position = truth.find(point.id);
    if (point.state != PointState::kStatic || true_position == truth.end()) continue;
    const Eigen::Vector3d error = truth_from_map * point.position - true_position->second;
    errors.push_back(error.norm());
    const Eigen::LLT<Eigen::Matrix3d> factor(linear * point.covariance * linear.transpose());
    if (factor.info() == Eigen::Success) nees.push_back(error.dot(factor.solve(error)));
  }
  PointAccuracy accuracy;
  accuracy.count = static_cast<int>(errors.size());
  accuracy.error_median_m = percentile(errors, 50);
  accuracy.error_p90_m = percentile(errors, 90);
  accuracy.nees_median = percentile(nees, 50);
  accuracy.nees_p90 = percentile(nees, 90);
  accuracy.nees_count = static_cast<int>(nees.size());
  return accuracy;
}

ErrorSpread spread_of(const std::vector<double>& errors) {
  return {percentile(errors, 50), percentile(errors, 90), static_cast<int>(errors.size())};
}

}  // namespace coslam::eval
