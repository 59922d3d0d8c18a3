// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <utility>
#include <vector>

#include "common/geometry/camera_model.h"
#include "common/geometry/pose_refinement.h"
#include "common/geometry/rigid3.h"
#include "common/geometry/steady_motion.h"

namespace coslam {

// Inter-camera pose problem: poses of several cameras at one instant, from the static points that each sees and the
// moving points that they see together (3):
//   argmin over poses and moving points of sum_c [ sum_static rho(|m - pi(M; T_c)|) + sum_moving rho(|m - pi(X; T_c)|)
//   ] + rho_prior(pose against its prior)
// Static points are not changed (their covariance weighs them), moving points are free.
struct InterPoseProblem {
  struct Camera {
    const CameraModel* model = nullptr;
    Rigid3 cam_from_world;  // initial estimate
    double sigma_px = 1.0;
    std::vector<PointObservation> statics;
    std::optional<PosePrior> prior;  // prediction of its motion model
  };
  struct MovingPoint {
    Eigen::Vector3d position;                           // initial estimate
    std::vector<std::pair<int, Eigen::Vector2d>> seen;  // camera index, undistorted pixel; at least two cameras
  };
  std::vector<Camera> cameras;
  std::vector<MovingPoint> moving;
  double moving_sigma_px = 1.0;  // least standard deviation of an observation of a moving point
};

struct InterPoseResult {
  bool ok = false;  // false: the observations do not determine the poses
  struct Camera {
    Rigid3 cam_from_world;
    Matrix6d covariance = Matrix6d::Zero();  // marginal, order of retract()
    int inliers = 0;                         // static and moving points together
  };
  std::vector<Camera> cameras;
  std::vector<Eigen::Vector3d> moving;
  int iterations = 0;
};

// Solves by Levenberg-Marquardt with the moving points eliminated (their 3x3 blocks), with Tukey's loss as in
// refine_pose().
InterPoseResult solve_inter_pose(const InterPoseProblem& problem, int max_iterations = 15);

}  // namespace coslam
