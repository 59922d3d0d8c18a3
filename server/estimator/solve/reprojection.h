// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "common/geometry/camera_model.h"
#include "common/geometry/lens_correction.h"
#include "common/geometry/rigid3.h"

// Terms that bundle adjustment minimises.
namespace coslam {

// Reprojection error (projection - observation), in raw px, over sigma_px, and its derivatives by the pose (retract())
// and by the point. A point behind the camera has a large constant error and zero derivatives; the loss and the outlier
// test deal with it. whiten: camera.raw_by_undistorted() at the observation, over sigma_px.
struct Reprojection {
  Eigen::Vector2d residual;
  Eigen::Matrix<double, 2, 6> by_pose;
  Eigen::Matrix<double, 2, 3> by_point;
};
Reprojection reprojection(const CameraModel& camera, const Eigen::Matrix2d& whiten,
                          const Eigen::Vector2d& undistorted_px, const Eigen::Matrix3d& rotation,
                          const Eigen::Vector3d& translation, const Eigen::Vector3d& point);
// Reprojection error without derivatives, for a point in the camera frame.
Eigen::Vector2d reprojection_residual(const CameraModel& camera, const Eigen::Matrix2d& whiten,
                                      const Eigen::Vector2d& undistorted_px, const Eigen::Vector3d& in_cam);

// Reprojection error with a lens correction, for an observation in the raw image. by_lens: derivative by
// LensCorrection::values.
Reprojection lens_reprojection(const CorrectedLens& lens, const Eigen::Vector2d& raw_px, double sigma_px,
                               const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation,
                               const Eigen::Vector3d& point, Eigen::Matrix<double, 2, LensCorrection::kTerms>* by_lens);
Eigen::Vector2d lens_reprojection_residual(const CorrectedLens& lens, const Eigen::Vector2d& raw_px, double sigma_px,
                                           const Eigen::Vector3d& in_cam);

// Residual of two poses against their tie, in standard deviations: rotation (3) of 1 mrad, which is how well a rig is
// calibrated and stays so, and translation (3) of a thousandth of the distance; and the derivatives by either pose.
struct Tie {
  Vector6d residual;
  Matrix6d by_first, by_second;
};
Tie tie(const Rigid3& second_from_first, const Rigid3& first, const Rigid3& second);

}  // namespace coslam
