// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "common/geometry/camera_model.h"
#include "common/geometry/rigid3.h"

namespace coslam {

// Feature that one camera followed, as a direction with an inverse depth: (x / z, y / z, 1 / z) in a frame that is
// fixed in the map, usually that of its first view. Infinity is a legal place.
struct WindowThing {
  Rigid3 frame_from_world;
  Eigen::Vector3d theta = Eigen::Vector3d::Zero();        // initial estimate
  Eigen::Vector3d prior = Eigen::Vector3d::Zero();        // prior estimate
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  // information matrix of the prior
  std::vector<std::pair<int, Eigen::Vector2d>> seen;      // index of the pose, undistorted pixel
};

// Window of the newest poses of one camera together with all that it followed in them, known or not:
//   argmin over free poses and things of sum_i [ sum_views rho(|m - pi(theta_i; T)| / sigma) + |theta_i - prior_i|^2 ]
// with Cauchy's loss. Poses that are not free tie the window to the map.
struct WindowProblem {
  const CameraModel* camera = nullptr;
  double sigma_px = 1.0;
  std::vector<Rigid3> cam_from_world;  // initial estimates
  std::vector<bool> is_free;           // one per pose
  std::vector<WindowThing> things;
};

struct WindowResult {
  std::vector<Rigid3> cam_from_world;  // one per pose; those that were not free are unchanged
  std::vector<Eigen::Vector3d> theta;  // one per thing
  double cost_before = 0, cost = 0;
  int iterations = 0;
};

// Solves by Levenberg-Marquardt with the things eliminated (their 3x3 blocks).
WindowResult solve_window(const WindowProblem& problem, int max_iterations = 50);

// Sets prior and start of a thing from a place that is known, in the thing's frame; false when it is not in front of
// it.
bool set_known(const Eigen::Vector3d& position, const Eigen::Matrix3d& covariance, WindowThing* thing);

// Converts a thing to a place in the map, homogeneous.
Eigen::Vector4d place_of(const Rigid3& frame_from_world, const Eigen::Vector3d& theta);
// Sets the start of a thing from a homogeneous place in the map, in the thing's own frame; false, and nothing
// changed, when it is not in front of it.
bool set_start(const Eigen::Vector4d& place, WindowThing* thing);

}  // namespace coslam
