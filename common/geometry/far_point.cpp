// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/far_point.h"

namespace coslam {

FarPoint far_point(const CameraModel& camera, const Rigid3& cam_from_world, const Eigen::Vector2d& undistorted_px,
                   double depth, double sigma_px) {
  const Eigen::Vector3d in_cam = depth * camera.normalized_from_pixel(undistorted_px).homogeneous();
  const Eigen::Vector3d along = cam_from_world.rotation.conjugate() * in_cam;
  const double distance = in_cam.norm(), across = sigma_px * distance / camera.focal_px();
  const Eigen::Vector3d u = along / distance;
  const Eigen::Matrix3d uu = u * u.transpose();
  return {cam_from_world.center() + along,
          distance * distance * uu + across * across * (Eigen::Matrix3d::Identity() - uu)};
}

}  // namespace coslam
