// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/triangulation.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace coslam {
namespace {

constexpr double kMinDepth = 1e-6;

std::vector<Eigen::Vector3d> centers_of(std::span<const View> views) {
  std::vector<Eigen::Vector3d> out;
  out.reserve(views.size());
  for (const View& v : views) out.push_back(v.cam_from_world.center());
  return out;
}

// Angle between the first ray and each other, then between the two extremes: enough for tracks, and linear.
double widest_angle(const std::vector<Eigen::Vector3d>& centers, const Eigen::Vector3d& point) {
  std::vector<Eigen::Vector3d> directions;
  directions.reserve(centers.size());
  for (const Eigen::Vector3d& center : centers) directions.emplace_back((point - center).normalized());
  const auto farthest = [&](const Eigen::Vector3d& from) {
    double least = 1.0;
    const Eigen::Vector3d* best = &from;
    for (const Eigen::Vector3d& d : directions) {
      const double cosine = d.dot(from);
      if (cosine < least) {
        least = cosine;
        best = &d;
      }
    }
    return std::pair(best, std::acos(std::clamp(least, -1.0, 1.0)));
  };
  const auto [one_end, unused] = farthest(directions.front());
  return farthest(*one_end).second;
}

bool linear_start(std::span<const View> views, const std::vector<Eigen::Vector3d>& centers, Eigen::Vector3d* point) {
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < views.size(); ++i) {
    const Eigen::Vector3d d = world_ray(views[i]);
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - d * d.transpose();
    a += across;
    b += across * centers[i];
  }
  const Eigen::LDLT<Eigen::Matrix3d> ldlt(a);
  if (ldlt.info() != Eigen::Success || ldlt.vectorD().minCoeff() < 1e-10) return false;
  *point = ldlt.solve(b);
  return point->allFinite();
}

struct Normal {
  Eigen::Matrix3d jtj = Eigen::Matrix3d::Zero();
  Eigen::Vector3d jtr = Eigen::Vector3d::Zero();
  double cost = 0;
  double max_error_px = 0;
};

// A view with what does not depend on the point.
struct Ready {
  const View& view;
  Eigen::Matrix2d raw_by_undistorted;
  Eigen::Matrix3d rotation;
};

std::vector<Ready> ready(std::span<const View> views) {
  std::vector<Ready> out;
  out.reserve(views.size());
  for (const View& v : views) {
    out.push_back({v, v.camera->raw_by_undistorted(v.undistorted_px), v.cam_from_world.rotation.toRotationMatrix()});
  }
  return out;
}

bool accumulate(const std::vector<Ready>& views, const Eigen::Vector3d& point, Normal* n) {
  for (const auto& [v, raw, rotation] : views) {
    const Eigen::Vector3d in_cam = v.cam_from_world * point;
    if (in_cam.z() < kMinDepth) return false;
    const Eigen::Vector2d r = raw * (v.undistorted_px - v.camera->project(in_cam));
    Eigen::Matrix<double, 2, 3> j = v.camera->project_jacobian(in_cam) * rotation;
    j = (raw * j).eval();
    n->jtj += j.transpose() * j;
    n->jtr += j.transpose() * r;
    n->cost += r.squaredNorm();
    n->max_error_px = std::max(n->max_error_px, r.norm());
  }
  return true;
}

}  // namespace

Eigen::Vector3d world_ray(const View& v) {
  const Eigen::Vector2d n = v.camera->normalized_from_pixel(v.undistorted_px);
  return (v.cam_from_world.rotation.conjugate() * Eigen::Vector3d(n.x(), n.y(), 1.0)).normalized();
}

bool project_world(const CameraModel& camera, const Rigid3& cam_from_world, const Eigen::Vector3d& point_in_world,
                   Eigen::Vector2d* undistorted_px, Eigen::Matrix<double, 2, 3>* jacobian) {
  const Eigen::Vector3d in_cam = cam_from_world * point_in_world;
  if (in_cam.z() < kMinDepth) return false;
  *undistorted_px = camera.project(in_cam);
  if (jacobian != nullptr) {
    *jacobian = camera.project_jacobian(in_cam) * cam_from_world.rotation.toRotationMatrix();
  }
  return true;
}

Eigen::Matrix3d triangulation_covariance(std::span<const View> views, const Eigen::Vector3d& position,
                                         double sigma_px) {
  Normal n;
  if (!accumulate(ready(views), position, &n)) return Eigen::Matrix3d::Identity() * 1e12;
  n.jtj.diagonal().array() += 1e-12 * n.jtj.trace();
  return n.jtj.inverse() * (sigma_px * sigma_px);
}

TriangulationResult triangulate(std::span<const View> views, double sigma_px, double min_parallax_rad) {
  TriangulationResult result;
  if (views.size() < 2) return result;
  result.status = TriangulationStatus::kTooLittleParallax;
  Eigen::Vector3d point;
  const std::vector<Eigen::Vector3d> centers = centers_of(views);
  if (!linear_start(views, centers, &point)) return result;
  result.parallax_rad = widest_angle(centers, point);
  if (result.parallax_rad < min_parallax_rad) return result;

  result.status = TriangulationStatus::kBehindCamera;
  double last_cost = -1;
  const std::vector<Ready> ready_views = ready(views);
  for (int i = 0; i < 8; ++i) {
    Normal n;
    if (!accumulate(ready_views, point, &n)) return result;
    result.position = point;
    result.max_error_px = n.max_error_px;
    result.covariance = n.jtj;
    if (last_cost >= 0 && std::abs(last_cost - n.cost) < 1e-6 * (1e-9 + last_cost)) break;
    last_cost = n.cost;
    const Eigen::Vector3d step = n.jtj.ldlt().solve(n.jtr);
    if (!step.allFinite()) {
      result.status = TriangulationStatus::kNotConverged;
      return result;
    }
    point += step;
  }
  if (!result.covariance.fullPivLu().isInvertible()) {
    result.status = TriangulationStatus::kNotConverged;
    return result;
  }
  result.covariance = (result.covariance.inverse() * (sigma_px * sigma_px)).eval();
  result.parallax_rad = widest_angle(centers, result.position);
  result.status =
      result.parallax_rad < min_parallax_rad ? TriangulationStatus::kTooLittleParallax : TriangulationStatus::kOk;
  return result;
}

}  // namespace coslam
