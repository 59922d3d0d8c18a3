// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "common/geometry/rigid3.h"

namespace coslam {

// Prior of a camera's pose, before the new image is used.
struct PosePrior {
  Rigid3 cam_from_world;
  Matrix6d covariance = Matrix6d::Zero();  // order of retract()
};

// Contribution of a prior to the normal equations of a pose (order of retract()) and to the sum of its losses.
struct PriorTerm {
  Matrix6d a;
  Vector6d b;
  double cost = 0;
};
// Cauchy's loss: who is pushed does not go on as he went.
PriorTerm prior_term(const PosePrior& prior, const Rigid3& cam_from_world);

// A camera that goes on as it went: its velocity and the uncertainty of pose and velocity, with white acceleration
//   x' = [1 dt; 0 1] x,  Q = q [dt^3/3 dt^2/2; dt^2/2 dt]
// as strong as its well-determined poses showed it in the last second or two, turning and moving each by itself. All in
// the camera's own axes, so that it stays true when the world is moved under the camera.
class SteadyMotion {
 public:
  // Longest time between images that the model covers: after longer the camera may have done anything.
  static constexpr double kLongestGap_s = 0.3;

  // Predicts the pose dt_s after that of the image before; the same pose when the velocity is not known.
  Rigid3 expected(const Rigid3& last_from_world, double dt_s) const;
  // Predicts the pose with its covariance; empty while the motion has been seen for too short a time.
  std::optional<PosePrior> predict(const Rigid3& last_from_world, double dt_s) const;
  // Takes in the pose dt_s after the last, and its covariance, estimated with the help of the prediction or without.
  // learn: the pose is valid without the prediction, so it tells how strongly the camera accelerates.
  void follow(const Rigid3& last_from_world, const Rigid3& cam_from_world, const Matrix6d& covariance, double dt_s,
              bool learn);
  // Takes in exact knowledge of the pose since_s ago: the newest pose is `off` (order of retract()) from where it was
  // thought to be.
  void correct(const Vector6d& off, double since_s);
  // The unit of length became shorter by that.
  void rescale(double factor);
  // Forgets the velocity.
  void lose() { known_ = false; }

 private:
  using Matrix12d = Eigen::Matrix<double, 12, 12>;
  Matrix12d predicted(double dt_s) const;
  void update(const Matrix12d& before, const Vector6d& off, const Matrix6d& covariance);

  bool known_ = false;
  Vector6d velocity_ = Vector6d::Zero();      // a second, order of retract()
  Matrix12d covariance_ = Matrix12d::Zero();  // joint covariance of pose and velocity
  double turn_ = 0, way_ = 0;                 // q of an axis, rad^2 / s^3 and m^2 / s^3
  double seen_s_ = 0;                         // duration that turn_ and way_ were learned from
};

}  // namespace coslam
