// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/cost_function.h>
#include <ceres/manifold.h>

#include <Eigen/Core>
#include <memory>

#include "common/geometry/camera_model.h"
#include "common/geometry/rigid3.h"

// What bundle.cpp gives to Ceres. A pose block holds a quaternion (x y z w) and a translation of cam_from_world.
namespace coslam {

// Moves a pose block by retract().
std::unique_ptr<ceres::Manifold> make_pose_manifold();

// (projection - observation), in raw px, / sigma_px of a pose block (7) and a point block (3). Its Jacobian by the pose
// is by the six local coordinates of the manifold above and stands in the first six columns; it is of use with that
// manifold only. Holds a reference to the camera.
std::unique_ptr<ceres::CostFunction> make_reprojection_cost(const CameraModel& camera,
                                                            const Eigen::Vector2d& undistorted_px, double sigma_px);

// The same with a third block of five: how the lens differs from the calibration (lens.h).
std::unique_ptr<ceres::CostFunction> make_lens_reprojection_cost(const CameraModel& camera,
                                                                 const Eigen::Vector2d& undistorted_px,
                                                                 double sigma_px);

// How far two pose blocks are from what ties them, in standard deviations: turn (3) of 1 mrad, as well as a rig is
// calibrated and keeps it, and shift (3) of a thousandth of the distance. The Jacobians are by local coordinates as
// above.
std::unique_ptr<ceres::CostFunction> make_tie_cost(const Rigid3& second_from_first);

}  // namespace coslam
