// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "common/geometry/camera_model.h"
#include "common/geometry/rigid3.h"

namespace coslam {

// What was seen once and has no depth yet is a direction. As a point: at a guessed depth on the ray of that view, with
// a covariance (world frame) that covers everything from half of it to infinity along the ray (standard deviation of
// the inverse depth = the inverse depth) and the noise of the view across it. A pose that rests on such points knows
// how the camera turned since that view, and as good as nothing of how far it went.
struct FarPoint {
  Eigen::Vector3d position;
  Eigen::Matrix3d covariance;
};

// depth > 0 along z of the camera; sigma_px of one coordinate of the view.
FarPoint far_point(const CameraModel& camera, const Rigid3& cam_from_world, const Eigen::Vector2d& undistorted_px,
                   double depth, double sigma_px);

}  // namespace coslam
