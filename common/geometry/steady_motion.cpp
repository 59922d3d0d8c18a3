// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/steady_motion.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace coslam {
namespace {

constexpr double kMemory_s = 1.5;  // of the acceleration
constexpr double kLeast_s = 0.3;   // below which it is not known
// Square of what a prediction from exact poses misses on three axes, over q dt^3, once the velocity has settled:
// 3 (1 / sqrt(12) + 1 / 3).
constexpr double kMissed = 1.866;
constexpr double kLeastQ = 1e-10;  // nothing is quite at rest
constexpr double kAny = 1e4;       // variance of a velocity of which nothing is known

// Square of the distance from a prior, six degrees of freedom, from which on it counts less.
constexpr double kPrior2 = 12;

}  // namespace

PriorTerm prior_term(const PosePrior& prior, const Rigid3& cam_from_world) {
  const Vector6d off = local(cam_from_world, prior.cam_from_world);
  const Matrix6d information = prior.covariance.inverse();
  const double d2 = off.dot(information * off), w = 1 / (1 + d2 / kPrior2);
  return {w * information, w * information * off, 0.5 * kPrior2 * std::log1p(d2 / kPrior2)};
}

SteadyMotion::Matrix12d SteadyMotion::predicted(double dt_s) const {
  Matrix12d f = Matrix12d::Identity();
  f.topRightCorner<6, 6>().diagonal().setConstant(dt_s);
  Matrix12d p = f * covariance_ * f.transpose();
  for (int i = 0; i < 6; ++i) {
    const double q = std::max(kLeastQ, i < 3 ? turn_ : way_);
    p(i, i) += q * dt_s * dt_s * dt_s / 3;
    p(i, i + 6) += q * dt_s * dt_s / 2;
    p(i + 6, i) += q * dt_s * dt_s / 2;
    p(i + 6, i + 6) += q * dt_s;
  }
  return p;
}

Rigid3 SteadyMotion::expected(const Rigid3& last_from_world, double dt_s) const {
  return known_ ? retract(last_from_world, velocity_ * dt_s) : last_from_world;
}

std::optional<PosePrior> SteadyMotion::predict(const Rigid3& last_from_world, double dt_s) const {
  if (!known_ || seen_s_ < kLeast_s) return std::nullopt;
  return PosePrior{expected(last_from_world, dt_s), predicted(dt_s).topLeftCorner<6, 6>()};
}

void SteadyMotion::follow(const Rigid3& last_from_world, const Rigid3& cam_from_world, const Matrix6d& covariance,
                          double dt_s, bool learn) {
  const Vector6d step = local(last_from_world, cam_from_world);
  if (!known_) {
    velocity_ = step / dt_s;
    covariance_.setZero();
    covariance_.topLeftCorner<6, 6>() = covariance;
    covariance_.bottomRightCorner<6, 6>().diagonal().setConstant(kAny);
    known_ = true;
    return;
  }
  const Vector6d off = step - velocity_ * dt_s;
  if (learn) {
    // The first steps count alike.
    seen_s_ = std::min(kMemory_s, seen_s_ + dt_s);
    const double share = dt_s / seen_s_, dt3 = dt_s * dt_s * dt_s;
    turn_ += share * (off.head<3>().squaredNorm() / (kMissed * dt3) - turn_);
    way_ += share * (off.tail<3>().squaredNorm() / (kMissed * dt3) - way_);
  }
  update(predicted(dt_s), off, covariance);
}

void SteadyMotion::correct(const Vector6d& off, double since_s) {
  if (!known_) return;
  // What is far more than it may be wrong by is a change of the world, of which its velocity tells nothing.
  const double d2 = off.dot(covariance_.topLeftCorner<6, 6>().ldlt().solve(off));
  const double share = std::isfinite(d2) ? 1 / (1 + d2 / kPrior2) : 0;
  update(covariance_, share * off, Matrix6d::Zero());
  if (known_ && since_s > 0) covariance_ = predicted(since_s);
}

void SteadyMotion::rescale(double factor) {
  Eigen::Matrix<double, 12, 1> scale = Eigen::Matrix<double, 12, 1>::Ones();
  scale.segment<3>(3).setConstant(factor);
  scale.segment<3>(9).setConstant(factor);
  velocity_.tail<3>() *= factor;
  covariance_ = scale.asDiagonal() * covariance_ * scale.asDiagonal();
  way_ *= factor * factor;
}

// The pose is known now as `covariance` says, whatever told it; the velocity follows as it hangs on the pose.
void SteadyMotion::update(const Matrix12d& before, const Vector6d& off, const Matrix6d& covariance) {
  const Matrix6d pose = before.topLeftCorner<6, 6>();
  const Eigen::LDLT<Matrix6d> ldlt(pose);
  const Matrix6d gain = ldlt.solve(before.topRightCorner<6, 6>()).transpose();  // P_vp P_pp^-1
  if (!gain.allFinite()) {
    lose();
    return;
  }
  velocity_ += gain * off;
  covariance_.topLeftCorner<6, 6>() = covariance;
  covariance_.bottomLeftCorner<6, 6>() = gain * covariance;
  covariance_.topRightCorner<6, 6>() = covariance_.bottomLeftCorner<6, 6>().transpose();
  covariance_.bottomRightCorner<6, 6>() =
      before.bottomRightCorner<6, 6>() - gain * (pose - covariance) * gain.transpose();
}

}  // namespace coslam
