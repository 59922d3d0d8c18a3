// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/camera_model.h"
#include "common/geometry/rigid3.h"
#include "common/geometry/steady_motion.h"

namespace coslam {

// A known point and where a camera sees it.
struct PointObservation {
  Eigen::Vector3d point_in_world = Eigen::Vector3d::Zero();
  Eigen::Matrix3d point_covariance = Eigen::Matrix3d::Zero();
  Eigen::Vector2d undistorted_px = Eigen::Vector2d::Zero();
  bool far = false;  // a far_point(): its covariance is ignorance, so it says nothing of the camera's noise
  int camera = 0;    // index of the camera of the rig that sees the point
};

// A camera of a rig.
struct RigView {
  const CameraModel* camera = nullptr;
  Rigid3 cam_from_rig;
};

// Least number of points that have to agree with a pose for it to be believed.
inline constexpr int kLeastInliers = 12;
// Number of points, and share of the image that they cover, from which on a pose needs nothing else.
inline constexpr int kFirmPoints = 30;
inline constexpr double kFirmHull = 0.2;
// Largest noise of detection and tracking that is believed, at 640 px image width.
inline constexpr double kMostSigma_px = 3.0;

struct PoseRefinementConfig {
  double sigma_px = kMostSigma_px;  // largest believed standard deviation of an observation
  double sigma_floor_px = 0.2;      // smallest: quantisation and sub-pixel accuracy of the tracker
  int max_iterations = 15;
  std::optional<PosePrior> prior;  // counts beside the observations, and in the covariance
};

enum class PoseStatus : std::uint8_t { kOk, kTooFewPoints, kTooFewInliers, kDegenerate };

struct PoseResult {
  PoseStatus status = PoseStatus::kTooFewPoints;
  Rigid3 cam_from_world;
  Matrix6d covariance = Matrix6d::Zero();  // (sum J^T W J)^-1, order of retract()
  double sigma_px = 0;                     // scale of the residuals that was measured
  int inliers = 0;
  std::vector<bool> is_inlier;  // one per observation
  int iterations = 0;
};

// Intra-camera pose (1), (2): argmin sum rho(|m_i - pi(M_i)|) in raw px, Tukey, by IRLS from `initial`. Each residual
// is weighted by its own covariance sigma^2 I + J Sigma_i J^T, and sigma is measured from the residuals (median), not
// above sigma_px.
PoseResult refine_pose(const CameraModel& camera, std::span<const PointObservation> observations, const Rigid3& initial,
                       const PoseRefinementConfig& config);

// Like refine_pose() for cameras that are fixed to each other: the pose is that of the rig, `cam_from_world` of the
// result is rig_from_world.
PoseResult refine_rig_pose(std::span<const RigView> rig, std::span<const PointObservation> observations,
                           const Rigid3& initial, const PoseRefinementConfig& config);

// Area of the convex hull of undistorted pixels over the area of the image.
double hull_fraction(std::vector<Eigen::Vector2d> p, const CameraModel& camera);

}  // namespace coslam
