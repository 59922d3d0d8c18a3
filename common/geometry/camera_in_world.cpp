// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/camera_in_world.h"

namespace coslam {

// With R = world from camera, a change (r, t) of cam_from_world moves the camera's centre by -R t and turns it by -R r
// about the axes of the world; the two signs cancel.
Matrix6d camera_covariance_in_world(const Rigid3& cam_from_world, const Matrix6d& covariance) {
  const Eigen::Matrix3d world_from_cam = cam_from_world.rotation.conjugate().toRotationMatrix();
  Matrix6d turn = Matrix6d::Zero();
  turn.topRightCorner<3, 3>() = world_from_cam;
  turn.bottomLeftCorner<3, 3>() = world_from_cam;
  return turn * covariance * turn.transpose();
}

}  // namespace coslam
