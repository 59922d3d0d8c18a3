// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

#include "common/geometry/triangulation.h"

namespace coslam {

// What has no depth yet is a direction: a point on the ray of its first view whose inverse depth is what the views so
// far say of it, which may be next to nothing. Its covariance (world frame) has the standard deviation of the inverse
// depth along the ray and the noise of the view across it. A pose that rests on such points knows how the camera turned
// since they were seen first, and of how far it went what their parallax tells.
struct FarPoint {
  Eigen::Vector3d position;
  Eigen::Matrix3d covariance;
  double inverse_depth = 0, sigma = 0;  // along z of the first view
};

// By the poses of these views, the first one first; at least one. Before anything is known of it the inverse depth is
// the usual one, give or take as much: everything from half the usual depth to infinity. sigma_px of one coordinate of
// a view.
FarPoint far_point(std::span<const View> views, double usual_depth, double sigma_px);

}  // namespace coslam
