// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/solve/bundle.h"

#include <ceres/ceres.h>

#include <array>
#include <cmath>

#include "common/geometry/robust.h"

namespace coslam {
namespace {

// A pose block: quaternion (x y z w), translation. Its local coordinates are those of retract().
class PoseManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return 6; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    const Rigid3 pose(Eigen::Map<const Eigen::Quaterniond>(x), Eigen::Map<const Eigen::Vector3d>(x + 4));
    const Rigid3 moved = retract(pose, Eigen::Map<const Vector6d>(delta));
    Eigen::Map<Eigen::Quaterniond> rotation(x_plus_delta);
    Eigen::Map<Eigen::Vector3d> translation(x_plus_delta + 4);
    rotation = moved.rotation;
    translation = moved.translation;
    return true;
  }
  // The cost below writes its Jacobian in local coordinates into the first six columns, so this is a plain selection.
  bool PlusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>> j(jacobian);
    j.setZero();
    j.topRows<6>().setIdentity();
    return true;
  }
  bool Minus(const double* y, const double* x, double* y_minus_x) const override {
    const Rigid3 from(Eigen::Map<const Eigen::Quaterniond>(x), Eigen::Map<const Eigen::Vector3d>(x + 4));
    const Rigid3 to(Eigen::Map<const Eigen::Quaterniond>(y), Eigen::Map<const Eigen::Vector3d>(y + 4));
    Eigen::Map<Vector6d> difference(y_minus_x);
    difference = local(from, to);
    return true;
  }
  bool MinusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>> j(jacobian);
    j.setZero();
    j.leftCols<6>().setIdentity();
    return true;
  }
};

class ReprojectionCost final : public ceres::SizedCostFunction<2, 7, 3> {
 public:
  ReprojectionCost(const CameraModel& camera, const Eigen::Vector2d& undistorted_px, double sigma_px)
      : camera_(camera), px_(undistorted_px), weight_(1.0 / sigma_px) {}

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const Eigen::Map<const Eigen::Quaterniond> q(parameters[0]);
    const Eigen::Map<const Eigen::Vector3d> t(parameters[0] + 4), point(parameters[1]);
    const Eigen::Matrix3d r = q.toRotationMatrix();
    const Eigen::Vector3d x = r * point + t;
    Eigen::Map<Eigen::Vector2d> residual(residuals);
    if (x.z() < 1e-4) {
      // Behind the camera: a large constant error that pulls nothing; the loss and the outlier test deal with it.
      residual.setConstant(1e3);
      if (jacobians != nullptr && jacobians[0] != nullptr) std::fill_n(jacobians[0], 14, 0.0);
      if (jacobians != nullptr && jacobians[1] != nullptr) std::fill_n(jacobians[1], 6, 0.0);
      return true;
    }
    residual = weight_ * (camera_.project(x) - px_);
    if (jacobians == nullptr) return true;
    const Eigen::Matrix<double, 2, 3> p = weight_ * camera_.project_jacobian(x);
    if (jacobians[0] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 2, 7, Eigen::RowMajor>> j(jacobians[0]);
      j.leftCols<3>() = -p * skew(x);
      j.middleCols<3>(3) = p;
      j.col(6).setZero();
    }
    if (jacobians[1] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 2, 3, Eigen::RowMajor>> j(jacobians[1]);
      j = p * r;
    }
    return true;
  }

 private:
  const CameraModel& camera_;
  Eigen::Vector2d px_;
  double weight_;
};

using Block = std::array<double, 7>;

Block to_block(const Rigid3& pose) {
  Block b{};
  Eigen::Map<Eigen::Quaterniond>(b.data()) = pose.rotation;
  Eigen::Map<Eigen::Vector3d>(b.data() + 4) = pose.translation;
  return b;
}

Rigid3 from_block(const Block& b) {
  return {Eigen::Map<const Eigen::Quaterniond>(b.data()).normalized(), Eigen::Map<const Eigen::Vector3d>(b.data() + 4)};
}

ceres::Solver::Options solver_options(const BundleConfig& config) {
  ceres::Solver::Options o;
  o.linear_solver_type = ceres::DENSE_SCHUR;
  o.max_num_iterations = config.max_iterations;
  o.num_threads = 1;  // same bits every time
  o.function_tolerance = 1e-5;
  o.logging_type = ceres::SILENT;
  o.initial_trust_region_radius = 1e5;
  return o;
}

void judge_observations(const BundleProblem& problem, const BundleConfig& config, BundleResult* result) {
  std::vector<double> norms_px;
  result->is_inlier.resize(problem.observations.size());
  for (std::size_t i = 0; i < problem.observations.size(); ++i) {
    const auto& o = problem.observations[i];
    const Eigen::Vector3d x =
        result->poses[static_cast<std::size_t>(o.pose)] * result->points[static_cast<std::size_t>(o.point)];
    if (x.z() < 1e-4) continue;
    const CameraModel& camera =
        problem.cameras[static_cast<std::size_t>(problem.poses[static_cast<std::size_t>(o.pose)].camera)];
    const double error_px = (camera.project(x) - o.undistorted_px).norm();
    norms_px.push_back(error_px);
    result->is_inlier[i] = error_px <= config.outlier_sigmas * o.sigma_px;
  }
  result->sigma_px = robust_sigma_2d(norms_px);
}

}  // namespace

BundleResult solve_bundle(const BundleProblem& problem, const BundleConfig& config) {
  BundleResult result;
  std::vector<Block> poses;
  for (const auto& p : problem.poses) poses.push_back(to_block(p.cam_from_world));
  result.points = problem.points;

  PoseManifold manifold;
  ceres::CauchyLoss loss(config.loss_sigmas);
  ceres::Problem::Options ownership;
  ownership.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem ceres_problem(ownership);
  for (Block& b : poses) ceres_problem.AddParameterBlock(b.data(), 7, &manifold);
  auto* ordering = new ceres::ParameterBlockOrdering;
  for (Block& b : poses) ordering->AddElementToGroup(b.data(), 1);
  for (Eigen::Vector3d& p : result.points) {
    ceres_problem.AddParameterBlock(p.data(), 3);
    ordering->AddElementToGroup(p.data(), 0);
  }
  for (const auto& o : problem.observations) {
    const auto pose = static_cast<std::size_t>(o.pose);
    const CameraModel& camera = problem.cameras[static_cast<std::size_t>(problem.poses[pose].camera)];
    ceres_problem.AddResidualBlock(new ReprojectionCost(camera, o.undistorted_px, o.sigma_px), &loss,
                                   poses[pose].data(), result.points[static_cast<std::size_t>(o.point)].data());
  }
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (problem.poses[i].fixed) ceres_problem.SetParameterBlockConstant(poses[i].data());
  }
  ceres::Solver::Options options = solver_options(config);
  options.linear_solver_ordering.reset(ordering);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &ceres_problem, &summary);

  result.usable = summary.IsSolutionUsable();
  result.initial_cost = summary.initial_cost;
  result.final_cost = summary.final_cost;
  result.iterations = static_cast<int>(summary.iterations.size());
  for (const Block& b : poses) result.poses.push_back(from_block(b));
  judge_observations(problem, config, &result);
  return result;
}

void fix_gauge(const BundleProblem& before, int anchor, int baseline_end, BundleResult* result) {
  const auto a = static_cast<std::size_t>(anchor), b = static_cast<std::size_t>(baseline_end);
  const auto distance = [&](const Rigid3& x, const Rigid3& y) { return (x.center() - y.center()).norm(); };
  const double old_length = distance(before.poses[a].cam_from_world, before.poses[b].cam_from_world);
  const double new_length = distance(result->poses[a], result->poses[b]);
  if (!(old_length > 0 && new_length > 0)) return;
  Similarity3 s;  // old_from_new
  s.scale = old_length / new_length;
  s.rotation = (before.poses[a].cam_from_world.rotation.conjugate() * result->poses[a].rotation).normalized();
  s.translation = before.poses[a].cam_from_world.center() - s.scale * (s.rotation * result->poses[a].center());
  for (Rigid3& p : result->poses) p = transform_world(p, s);
  for (Eigen::Vector3d& p : result->points) p = s * p;
}

}  // namespace coslam
