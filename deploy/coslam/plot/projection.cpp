// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/plot/projection.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace coslam::plot {
namespace {

double quantile(std::vector<double> values, double fraction) {
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

std::vector<double> coordinates(const Positions& positions, int axis) {
  std::vector<double> values;
  for (const Eigen::Vector3d& p : positions) values.push_back(p[axis]);
  return values;
}

// Wild points stand far outside the box of the others, widened by half.
Positions without_outliers(const Positions& points) {
  if (points.empty()) return {};
  Eigen::Vector3d low, high;
  for (int axis = 0; axis < 3; ++axis) {
    low[axis] = quantile(coordinates(points, axis), 0.02);
    high[axis] = quantile(coordinates(points, axis), 0.98);
  }
  const Eigen::Vector3d margin = 0.5 * (high - low);
  Positions inside_points;
  for (const Eigen::Vector3d& p : points) {
    const bool inside = ((p - low + margin).array() >= 0).all() && ((high + margin - p).array() >= 0).all();
    if (inside) inside_points.push_back(p);
  }
  return inside_points;
}

Positions all_paths(const TopView& view) {
  Positions positions;
  for (const TopViewPath& path : view.paths) {
    positions.insert(positions.end(), path.estimate.begin(), path.estimate.end());
    positions.insert(positions.end(), path.truth.begin(), path.truth.end());
  }
  return positions;
}

struct Spread {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

Spread spread_of(const Positions& positions) {
  Spread s;
  if (positions.empty()) return s;
  const double count = static_cast<double>(positions.size());
  for (const Eigen::Vector3d& p : positions) s.mean += p / count;
  for (const Eigen::Vector3d& p : positions) s.covariance += (p - s.mean) * (p - s.mean).transpose() / count;
  return s;
}

// The normal of the plane of widest spread, or "up" when the cameras agree on it and it is not far from that: a room
// seen from one corner spreads along a wall too.
Eigen::Vector3d view_normal(const Eigen::Matrix3d& covariance, const Eigen::Vector3d& up) {
  constexpr double kAgreed = 0.9, kFar = 0.5;  // length of the mean; cosine of 60 degrees
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  const Eigen::Vector3d thinnest = solver.eigenvectors().col(0);
  const double agreement = thinnest.dot(up);
  if (up.norm() > kAgreed && std::abs(agreement) > kFar * up.norm()) return up.normalized();
  return agreement < 0 ? Eigen::Vector3d(-thinnest) : thinnest;
}

}  // namespace

Projection widest_plane(const TopView& view) {
  const Positions paths = all_paths(view), points = without_outliers(view.points);
  // Paths and points count alike, however many there are of each.
  const Spread of_paths = spread_of(paths), of_points = spread_of(points);
  const Eigen::Matrix3d covariance = of_paths.covariance + of_points.covariance;
  const Eigen::Vector3d normal = view_normal(covariance, view.up);  // towards the viewer
  const Eigen::Matrix3d flatten = Eigen::Matrix3d::Identity() - normal * normal.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> flat(flatten * covariance * flatten);
  // A world without extent has no axes of its own.
  Eigen::Vector3d widest = flatten * flat.eigenvectors().col(2);
  if (widest.norm() < 0.5) widest = normal.unitOrthogonal();
  widest.normalize();

  Projection projection;
  projection.center = paths.empty() ? of_points.mean : of_paths.mean;
  projection.axes.row(0) = widest.transpose();
  projection.axes.row(1) = normal.cross(widest).transpose();
  Positions shown = paths;
  shown.insert(shown.end(), points.begin(), points.end());
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const Eigen::Vector2d p = projection(shown[i]);
    projection.min = i == 0 ? p : Eigen::Vector2d(projection.min.cwiseMin(p));
    projection.max = i == 0 ? p : Eigen::Vector2d(projection.max.cwiseMax(p));
  }
  return projection;
}

}  // namespace coslam::plot
