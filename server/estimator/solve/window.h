// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "common/geometry/camera_model.h"
#include "common/geometry/rigid3.h"

namespace coslam {

// A thing that one camera followed, as a direction with an inverse depth: (x / z, y / z, 1 / z) in a frame that stands
// still, usually that of its first view. Infinity is a legal place.
struct WindowThing {
  Rigid3 frame_from_world;
  Eigen::Vector3d theta = Eigen::Vector3d::Zero();        // where to start
  Eigen::Vector3d prior = Eigen::Vector3d::Zero();        // what is known of it beforehand
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  // of the prior
  std::vector<std::pair<int, Eigen::Vector2d>> seen;      // index of the pose, undistorted pixel
};

// The newest poses of one camera together with all that it followed in them, known or not:
//   argmin over free poses and things of sum_i [ sum_views rho(|m - pi(theta_i; T)| / sigma) + |theta_i - prior_i|^2 ]
// with Cauchy's loss. Poses that are not free tie the window to the map.
struct WindowProblem {
  const CameraModel* camera = nullptr;
  double sigma_px = 1.0;
  std::vector<Rigid3> cam_from_world;  // where to start
  std::vector<bool> is_free;           // one a pose
  std::vector<WindowThing> things;
};

struct WindowResult {
  std::vector<Rigid3> cam_from_world;  // one a pose, those that were not free as they were
  std::vector<Eigen::Vector3d> theta;  // one a thing
  double cost_before = 0, cost = 0;
  int iterations = 0;
};

// Levenberg-Marquardt with the things eliminated (their 3x3 blocks).
WindowResult solve_window(const WindowProblem& problem, int max_iterations = 50);

// Makes a place that is known the prior and the start of a thing with that frame; false when it is not in front of it.
bool set_known(const Eigen::Vector3d& position, const Eigen::Matrix3d& covariance, WindowThing* thing);

// A thing's place in the world, homogeneous; and a thing of that place to start from, with its own frame: false, and
// nothing changed, when it is not in front of it.
Eigen::Vector4d place_of(const Rigid3& frame_from_world, const Eigen::Vector3d& theta);
bool set_start(const Eigen::Vector4d& place, WindowThing* thing);

}  // namespace coslam
