// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/map/edit.h"

namespace coslam {

struct VerifyConfig {
  int failures = 3;               // gate failures in succession that unbind a track
  bool leave_moved = false;       // points that several cameras see elsewhere are left as they are, for classify()
  int prove_views = 20;           // frames inside the gate that prove a point of one camera; of several: half
  int sparse_points = 60;         // a camera that sees fewer proven points relies on the others too
  double update_turn_rad = 0.02;  // the viewing ray must have turned so far since the point's last filter update
};

struct VerifyReport {
  int inside = 0, outside = 0, unbound = 0, updated = 0;
};

// Every new observation of a bound static point against its prediction: gate theta on r^T (J Sigma J^T + sigma^2 I)^-1
// r (8). Inside: Kalman update (5)-(7) once the ray has turned far enough, since observations of one track are
// correlated in time, and the point is proven. A patch that came
// now becomes the point's. Outside for several sets: the track no longer follows the point.
VerifyReport verify(MapEdit& edit, const FrameSet& set, const VerifyConfig& config);

struct PointEstimate {
  Eigen::Vector3d position;
  Eigen::Matrix3d covariance;
};

// Kalman update (5)-(7) in Joseph form; sigma_px of one coordinate of the observation.
PointEstimate kalman_update(const MapPoint& point, const CameraModel& camera, const Rigid3& cam_from_world,
                            const Eigen::Vector2d& undistorted_px, double sigma_px);

// Squared Mahalanobis distance (8) of an observation; empty when the point is not in front of the camera.
std::optional<double> gate_distance2(const MapPoint& point, const CameraModel& camera, const Rigid3& cam_from_world,
                                     const Eigen::Vector2d& undistorted_px, double sigma_px);

}  // namespace coslam
