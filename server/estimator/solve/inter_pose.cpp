// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/solve/inter_pose.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "common/geometry/levenberg_marquardt.h"
#include "common/geometry/robust.h"

namespace coslam {
namespace {

using Matrix63 = Eigen::Matrix<double, 6, 3>;

struct Projected {
  Eigen::Vector2d r;
  Eigen::Matrix<double, 2, 6> by_pose;
  Eigen::Matrix<double, 2, 3> by_point;
};

bool project(const CameraModel& camera, const Rigid3& pose, const Eigen::Matrix3d& rotation,
             const Eigen::Vector3d& point, const Eigen::Vector2d& px, Projected* out) {
  const Eigen::Vector3d x = rotation * point + pose.translation;
  if (x.z() < 1e-6) return false;
  const Eigen::Matrix2d raw = camera.raw_by_undistorted(px);
  const Eigen::Matrix<double, 2, 3> j = raw * camera.project_jacobian(x);
  out->r = raw * (px - camera.project(x));
  out->by_pose << -j * skew(x), j;
  out->by_point = j * rotation;
  return true;
}

struct InterPoseState {
  std::vector<Rigid3> poses;
  std::vector<Eigen::Vector3d> points;
};

struct InterPoseSystem {
  Eigen::MatrixXd a;
  Eigen::VectorXd b;
  std::vector<Eigen::Matrix3d> point_blocks;  // of moving points
  std::vector<Eigen::Vector3d> right;         // likewise
  std::vector<std::vector<std::pair<int, Matrix63>>> coupling;
  std::vector<int> inliers;
  double cost = 0;
};

struct Sigmas {
  std::vector<double> still_px, moving_px;  // by camera
};

bool alike(const Sigmas& a, const Sigmas& b) {
  const auto near = [](double x, double y) { return std::abs(x - y) < 0.01 * y; };
  return std::equal(a.moving_px.begin(), a.moving_px.end(), b.moving_px.begin(), near) &&
         std::equal(a.still_px.begin(), a.still_px.end(), b.still_px.begin(), near);
}

// Scale of each camera's residuals, not below its sigma: the start may be far off, and the loss follows the residuals
// down. Those of moving points have a scale of their own: their tracks drift, and cameras follow neighbouring corners.
// By camera, too: one whose few static points put it far off has all its moving points far off, and needs them.
Sigmas measured_sigmas(const InterPoseProblem& problem, const InterPoseState& state) {
  const std::size_t cameras = problem.cameras.size();
  std::vector<std::vector<double>> still(cameras), moving(cameras);
  const auto add = [&](std::size_t c, const Eigen::Vector3d& point, const Eigen::Vector2d& px,
                       std::vector<double>* to) {
    const Eigen::Vector3d x = state.poses[c] * point;
    const CameraModel& model = *problem.cameras[c].model;
    if (x.z() > 1e-6) to->push_back((model.raw_by_undistorted(px) * (px - model.project(x))).norm());
  };
  for (std::size_t c = 0; c < cameras; ++c) {
    for (const PointObservation& o : problem.cameras[c].statics) add(c, o.point_in_world, o.undistorted_px, &still[c]);
  }
  for (std::size_t m = 0; m < problem.moving.size(); ++m) {
    for (const auto& [camera, px] : problem.moving[m].seen) {
      const auto c = static_cast<std::size_t>(camera);
      add(c, state.points[m], px, &moving[c]);
    }
  }
  Sigmas sigmas;
  for (std::size_t c = 0; c < cameras; ++c) {
    sigmas.still_px.push_back(std::max(problem.cameras[c].sigma_px, robust_sigma_2d(still[c])));
    sigmas.moving_px.push_back(std::max(problem.moving_sigma_px, robust_sigma_2d(moving[c])));
  }
  return sigmas;
}

// Adds what static points and priors say of each camera's pose.
void add_statics(const InterPoseProblem& problem, const InterPoseState& state,
                 const std::vector<Eigen::Matrix3d>& rotations, const Sigmas& sigmas, InterPoseSystem* system) {
  InterPoseSystem& s = *system;
  Projected p;
  for (std::size_t c = 0; c < problem.cameras.size(); ++c) {
    const auto& camera = problem.cameras[c];
    const auto at = static_cast<Eigen::Index>(6 * c);
    for (const PointObservation& o : camera.statics) {
      if (!project(*camera.model, state.poses[c], rotations[c], o.point_in_world, o.undistorted_px, &p)) {
        s.cost += tukey_rho(2 * kTukeyOfTwo, kTukeyOfTwo);
        continue;
      }
      const Eigen::Matrix2d information = (sigmas.still_px[c] * sigmas.still_px[c] * Eigen::Matrix2d::Identity() +
                                           p.by_point * o.point_covariance * p.by_point.transpose())
                                              .inverse();
      const double d = std::sqrt(p.r.dot(information * p.r)), w = tukey_weight(d, kTukeyOfTwo);
      s.cost += tukey_rho(d, kTukeyOfTwo);
      if (w <= 0) continue;
      ++s.inliers[c];
      const Eigen::Matrix<double, 6, 2> jw = p.by_pose.transpose() * (w * information);
      s.a.block<6, 6>(at, at) += jw * p.by_pose;
      s.b.segment<6>(at) += jw * p.r;
    }
    if (camera.prior) {
      const PriorTerm prior = prior_term(*camera.prior, state.poses[c]);
      s.a.block<6, 6>(at, at) += prior.a;
      s.b.segment<6>(at) += prior.b;
      s.cost += prior.cost;
    }
  }
}

// Adds what moving points say, whose positions are unknown like the poses.
void add_moving(const InterPoseProblem& problem, const InterPoseState& state,
                const std::vector<Eigen::Matrix3d>& rotations, const Sigmas& sigmas, InterPoseSystem* system) {
  InterPoseSystem& s = *system;
  Projected p;
  for (std::size_t m = 0; m < problem.moving.size(); ++m) {
    for (const auto& [camera, px] : problem.moving[m].seen) {
      const auto c = static_cast<std::size_t>(camera);
      const double sigma_px = sigmas.moving_px[c];
      if (!project(*problem.cameras[c].model, state.poses[c], rotations[c], state.points[m], px, &p)) {
        s.cost += tukey_rho(2 * kTukeyOfTwo, kTukeyOfTwo);
        continue;
      }
      const double d = p.r.norm() / sigma_px, w = tukey_weight(d, kTukeyOfTwo) / (sigma_px * sigma_px);
      s.cost += tukey_rho(d, kTukeyOfTwo);
      if (w <= 0) continue;
      ++s.inliers[c];
      const auto at = static_cast<Eigen::Index>(6 * c);
      s.a.block<6, 6>(at, at) += w * p.by_pose.transpose() * p.by_pose;
      s.b.segment<6>(at) += w * p.by_pose.transpose() * p.r;
      s.point_blocks[m] += w * p.by_point.transpose() * p.by_point;
      s.right[m] += w * p.by_point.transpose() * p.r;
      s.coupling[m].emplace_back(camera, w * p.by_pose.transpose() * p.by_point);
    }
  }
}

InterPoseSystem build(const InterPoseProblem& problem, const InterPoseState& state, const Sigmas& sigmas) {
  const auto n = static_cast<Eigen::Index>(6 * problem.cameras.size());
  InterPoseSystem s{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n), {}, {}, {}, {}, 0};
  s.point_blocks.assign(problem.moving.size(), Eigen::Matrix3d::Zero());
  s.right.assign(problem.moving.size(), Eigen::Vector3d::Zero());
  s.coupling.resize(problem.moving.size());
  s.inliers.assign(problem.cameras.size(), 0);
  std::vector<Eigen::Matrix3d> rotations;
  for (const Rigid3& pose : state.poses) rotations.push_back(pose.rotation.toRotationMatrix());
  add_statics(problem, state, rotations, sigmas, &s);
  add_moving(problem, state, rotations, sigmas, &s);
  return s;
}

Eigen::Matrix3d damped_inverse(Eigen::Matrix3d block, double lambda) {
  block.diagonal() *= 1 + lambda;
  block.diagonal().array() += 1e-9 * (1e-9 + block.trace());
  return block.inverse();
}

// Takes the moving points out: what is left speaks of the poses alone.
void eliminate(const InterPoseSystem& s, double lambda, Eigen::MatrixXd* a, Eigen::VectorXd* b) {
  *a = s.a;
  *b = s.b;
  for (std::size_t m = 0; m < s.point_blocks.size(); ++m) {
    if (s.coupling[m].size() < 2) continue;
    const Eigen::Matrix3d inverse = damped_inverse(s.point_blocks[m], lambda);
    for (const auto& [i, wi] : s.coupling[m]) {
      const Matrix63 left = wi * inverse;
      b->segment<6>(6 * i) -= left * s.right[m];
      for (const auto& [j, wj] : s.coupling[m]) a->block<6, 6>(6 * i, 6 * j) -= left * wj.transpose();
    }
  }
}

InterPoseState stepped(const InterPoseSystem& s, const InterPoseState& state, const Eigen::VectorXd& step,
                       double lambda) {
  InterPoseState next = state;
  for (std::size_t c = 0; c < state.poses.size(); ++c) {
    next.poses[c] = retract(state.poses[c], step.segment<6>(static_cast<Eigen::Index>(6 * c)));
  }
  for (std::size_t m = 0; m < state.points.size(); ++m) {
    Eigen::Vector3d right = s.right[m];
    for (const auto& [i, wi] : s.coupling[m]) right -= wi.transpose() * step.segment<6>(6 * i);
    next.points[m] += damped_inverse(s.point_blocks[m], lambda) * right;
  }
  return next;
}

}  // namespace

InterPoseResult solve_inter_pose(const InterPoseProblem& problem, int max_iterations) {
  InterPoseResult result;
  InterPoseState state;
  for (const auto& c : problem.cameras) state.poses.push_back(c.cam_from_world);
  for (const auto& m : problem.moving) state.points.push_back(m.position);
  Sigmas sigmas = measured_sigmas(problem, state);
  InterPoseSystem s = build(problem, state, sigmas);
  Eigen::MatrixXd a;
  Eigen::VectorXd b;
  result.iterations = levenberg_marquardt({}, max_iterations, [&](double lambda) {
    eliminate(s, lambda, &a, &b);
    a.diagonal() *= 1 + lambda;
    const Eigen::VectorXd step = a.ldlt().solve(b);
    if (!step.allFinite()) return LmStep::kImpossible;
    const InterPoseState next = stepped(s, state, step, lambda);
    const double cost = build(problem, next, sigmas).cost;
    if (cost > s.cost * (1 + 1e-9)) return LmStep::kFailed;
    const double improved = s.cost - cost;
    const Sigmas before = std::exchange(sigmas, measured_sigmas(problem, next));
    const bool settled = alike(sigmas, before) && improved < 1e-6 * s.cost;
    state = next;
    s = build(problem, state, sigmas);
    return settled ? LmStep::kConverged : LmStep::kImproved;
  });
  eliminate(s, 0, &a, &b);
  // Scaled to a unit diagonal, so that the test does not depend on the units of angle and length.
  const Eigen::VectorXd scale = a.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::LDLT<Eigen::MatrixXd> ldlt(scale.asDiagonal() * a * scale.asDiagonal());
  constexpr double kMinPivot = 1e-9;
  if (!scale.allFinite() || ldlt.info() != Eigen::Success || !(ldlt.vectorD().minCoeff() > kMinPivot)) return result;
  const Eigen::MatrixXd covariance =
      scale.asDiagonal() * ldlt.solve(Eigen::MatrixXd::Identity(a.rows(), a.cols())) * scale.asDiagonal();
  for (std::size_t c = 0; c < state.poses.size(); ++c) {
    const auto at = static_cast<Eigen::Index>(6 * c);
    result.cameras.push_back({state.poses[c], covariance.block<6, 6>(at, at), s.inliers[c]});
  }
  result.moving = state.points;
  result.ok = covariance.allFinite();
  return result;
}

}  // namespace coslam
