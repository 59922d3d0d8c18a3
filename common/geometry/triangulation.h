// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "common/geometry/camera_model.h"
#include "common/geometry/rigid3.h"

namespace coslam {

// Rotation of a viewing ray from which on a further view tells something new of a point.
inline constexpr double kNewView_rad = 0.02;

// One view of a point.
struct View {
  const CameraModel* camera = nullptr;
  Rigid3 cam_from_world;
  Eigen::Vector2d undistorted_px = Eigen::Vector2d::Zero();
};

enum class TriangulationStatus : std::uint8_t {
  kOk,
  kTooFewViews,
  kTooLittleParallax,  // below the bound given, or rays parallel
  kBehindCamera,
  kNotConverged,
};

struct TriangulationResult {
  TriangulationStatus status = TriangulationStatus::kTooFewViews;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();    // world
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // (J^T J)^-1 sigma^2 (4)
  double parallax_rad = 0;                               // widest angle between two rays
  double max_error_px = 0;                               // largest reprojection error, raw px
};

// Least squares point of all views: linear start from the rays, Gauss-Newton on the reprojection error.
// sigma_px: standard deviation of one coordinate of an observation in the raw image.
TriangulationResult triangulate(std::span<const View> views, double sigma_px, double min_parallax_rad);

// Covariance (4) of a point seen in these views.
Eigen::Matrix3d triangulation_covariance(std::span<const View> views, const Eigen::Vector3d& position, double sigma_px);

// Unit ray of an observation in the world.
Eigen::Vector3d world_ray(const View& view);

// Projection of a world point, its Jacobian by the point (2x3); false when not in front of the camera.
bool project_world(const CameraModel& camera, const Rigid3& cam_from_world, const Eigen::Vector3d& point_in_world,
                   Eigen::Vector2d* undistorted_px, Eigen::Matrix<double, 2, 3>* jacobian = nullptr);

}  // namespace coslam
