// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

#include "common/geometry/triangulation.h"

namespace coslam {

// A point without known depth: it lies on the ray of its first view, and its inverse depth is the estimate from the
// views so far, which may be close to zero. Its covariance (world frame) has the standard deviation of the inverse
// depth along the ray and the noise of the view across it. A pose estimated from such points has the rotation since
// they were first seen; its translation rests on their parallax alone.
struct FarPoint {
  Eigen::Vector3d position;
  Eigen::Matrix3d covariance;
  double inverse_depth = 0, sigma = 0;  // along z of the first view
};

// Estimates a far point from the views with their poses, the first view first; at least one. The prior of the inverse
// depth is 1 / usual_depth with a standard deviation of the same size, which covers half the usual depth to infinity.
// sigma_px is the noise of one coordinate of a view.
FarPoint far_point(std::span<const View> views, double usual_depth, double sigma_px);

}  // namespace coslam
