// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/places/scene_shape.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>

#include "common/geometry/robust.h"

namespace coslam {

bool covers_ground(const std::vector<const MapPoint*>& points, double farthest_depth) {
  constexpr std::size_t kLeast = 100;            // points
  constexpr double kAlong = 2.5, kAcross = 0.5;  // distances
  constexpr double kInside = 0.05;               // of the points, on either side, may be strays
  if (points.size() < kLeast) return false;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const MapPoint* p : points) mean += p->position / static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const MapPoint* p : points) spread += (p->position - mean) * (p->position - mean).transpose();
  const Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors();
  const auto width = [&](int axis) {
    std::vector<double> along;
    along.reserve(points.size());
    for (const MapPoint* p : points) along.push_back(axes.col(axis).dot(p->position - mean));
    std::ranges::sort(along);
    const auto strays = static_cast<std::size_t>(kInside * static_cast<double>(along.size()));
    return along[along.size() - 1 - strays] - along[strays];
  };
  return width(2) > kAlong * farthest_depth && width(1) > kAcross * farthest_depth;
}

bool has_relief(const std::vector<const MapPoint*>& points, double median_depth) {
  constexpr double kFlat = 0.03;        // of the distance
  constexpr double kSigmas = 3;         // of a point along the plane's normal
  constexpr std::size_t kLeastOff = 6;  // points: more than are mismatched
  constexpr int kTries = 100;
  if (points.size() < 4) return false;
  std::mt19937 random(1);
  std::size_t least_off = points.size();
  for (int i = 0; i < kTries; ++i) {
    const auto any = [&] { return points[random() % points.size()]->position; };
    const Eigen::Vector3d a = any(), b = any(), c = any();
    const Eigen::Vector3d n = (b - a).cross(c - a);
    if (n.norm() < 1e-9 * median_depth * median_depth) continue;
    const Eigen::Vector3d normal = n.normalized();
    const auto off = static_cast<std::size_t>(std::count_if(points.begin(), points.end(), [&](const MapPoint* p) {
      const double sigma = std::sqrt(std::max(0.0, normal.dot(p->covariance * normal)));
      return std::abs(normal.dot(p->position - a)) > std::max(kFlat * median_depth, kSigmas * sigma);
    }));
    least_off = std::min(least_off, off);
  }
  return least_off >= kLeastOff;
}

}  // namespace coslam
