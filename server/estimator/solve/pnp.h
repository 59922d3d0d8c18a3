// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/geometry/camera_model.h"
#include "common/geometry/rigid3.h"

namespace coslam {

struct PnpResult {
  bool ok = false;
  Rigid3 cam_from_world;
  std::vector<int> inliers;
};

// Estimates a pose by PnP with RANSAC from 2D-3D correspondences, and refines it.
PnpResult solve_pnp(const CameraModel& camera, const std::vector<Eigen::Vector3d>& points,
                    const std::vector<Eigen::Vector2d>& undistorted_px, double sigma_px, int min_inliers);

}  // namespace coslam
