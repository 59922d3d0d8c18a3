// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/ceres_bundle.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "common/geometry/rigid3.h"
#include "server/estimator/solve/reprojection.h"

namespace coslam::test {
namespace {

using Block = std::array<double, 7>;

void write_block(const Rigid3& pose, double* block) {
  Eigen::Map<Eigen::Quaterniond>{block} = pose.rotation;
  Eigen::Map<Eigen::Vector3d>{block + 4} = pose.translation;
}

Rigid3 pose_of(const double* block) {
  return {Eigen::Map<const Eigen::Quaterniond>(block).normalized(), Eigen::Map<const Eigen::Vector3d>(block + 4)};
}

// Between the seven numbers of a block and its six local coordinates, as far as the costs below take part: they write
// their Jacobians in local coordinates into the first six columns.
void select_first_six(Eigen::Ref<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> jacobian) {
  jacobian.setZero();
  jacobian.topLeftCorner<6, 6>().setIdentity();
}

class PoseManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return 6; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    write_block(retract(pose_of(x), Eigen::Map<const Vector6d>(delta)), x_plus_delta);
    return true;
  }
  bool PlusJacobian(const double*, double* jacobian) const override {
    select_first_six(Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>>(jacobian));
    return true;
  }
  bool Minus(const double* y, const double* x, double* y_minus_x) const override {
    Eigen::Map<Vector6d>{y_minus_x} = local(pose_of(x), pose_of(y));
    return true;
  }
  bool MinusJacobian(const double*, double* jacobian) const override {
    select_first_six(Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>>(jacobian));
    return true;
  }
};

// Of a pose block (7), a point block (3) and a lens block (12). Its Jacobian by the pose is by the six local
// coordinates of the manifold above and stands in the first six columns.
class LensReprojectionCost final : public ceres::SizedCostFunction<2, 7, 3, LensCorrection::kTerms> {
 public:
  LensReprojectionCost(const CameraModel& camera, const Eigen::Vector2d& calibrated_px, double sigma_px)
      : camera_(camera), raw_px_(camera.raw_from_undistorted(calibrated_px)), sigma_px_(sigma_px) {}

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const Eigen::Map<const Eigen::Quaterniond> q(parameters[0]);
    const Eigen::Map<const Eigen::Vector3d> t(parameters[0] + 4), point(parameters[1]);
    const LensCorrection lens{Eigen::Map<const LensCorrection::Values>(parameters[2])};
    Eigen::Matrix<double, 2, LensCorrection::kTerms> by_lens;
    const Reprojection r =
        lens_reprojection({camera_, lens}, raw_px_, sigma_px_, q.toRotationMatrix(), t, point, &by_lens);
    Eigen::Map<Eigen::Vector2d>{residuals} = r.residual;
    if (jacobians == nullptr) return true;
    if (jacobians[0] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 2, 7, Eigen::RowMajor>> j(jacobians[0]);
      j << r.by_pose, Eigen::Vector2d::Zero();
    }
    if (jacobians[1] != nullptr) Eigen::Map<Eigen::Matrix<double, 2, 3, Eigen::RowMajor>>{jacobians[1]} = r.by_point;
    if (jacobians[2] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 2, LensCorrection::kTerms, Eigen::RowMajor>>{jacobians[2]} = by_lens;
    }
    return true;
  }

 private:
  const CameraModel& camera_;
  Eigen::Vector2d raw_px_;
  double sigma_px_;
};

// How sure a calibration is of one of a lens's values.
class LensPriorCost final : public ceres::SizedCostFunction<1, LensCorrection::kTerms> {
 public:
  LensPriorCost(int which, double sigma) : which_(which), sigma_(sigma) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    residuals[0] = parameters[0][which_] / sigma_;
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    std::fill_n(jacobians[0], LensCorrection::kTerms, 0.0);
    jacobians[0][which_] = 1 / sigma_;
    return true;
  }

 private:
  int which_;
  double sigma_;
};

class TieCost final : public ceres::SizedCostFunction<6, 7, 7> {
 public:
  explicit TieCost(const Rigid3& second_from_first) : tie_(second_from_first) {}

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const Tie is = tie(tie_, pose_of(parameters[0]), pose_of(parameters[1]));
    Eigen::Map<Vector6d>{residuals} = is.residual;
    for (int i = 0; jacobians != nullptr && i < 2; ++i) {
      if (jacobians[i] == nullptr) continue;
      Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>> j(jacobians[i]);
      j.leftCols<6>() = i == 0 ? is.by_first : is.by_second;
      j.col(6).setZero();
    }
    return true;
  }

 private:
  Rigid3 tie_;
};

ceres::Solver::Options solver_options(const BundleConfig& config, const BundleProblem& problem) {
  constexpr std::ptrdiff_t kDenseMost = 120;  // beyond, a whole run: most poses share no point
  const auto free_poses = std::ranges::count(problem.poses, false, &BundleProblem::Pose::fixed);
  ceres::Solver::Options o;
  o.linear_solver_type = free_poses > kDenseMost ? ceres::SPARSE_SCHUR : ceres::DENSE_SCHUR;
  o.max_num_iterations = config.max_iterations;
  o.num_threads = 1;  // same bits every time
  o.function_tolerance = config.function_tolerance;
  o.logging_type = ceres::SILENT;
  o.initial_trust_region_radius = 1e5;
  return o;
}

void add_ties(const BundleProblem& problem, std::vector<Block>* poses, ceres::Problem* ceres_problem) {
  for (const auto& t : problem.ties) {
    ceres_problem->AddResidualBlock(new TieCost(t.second_from_first), nullptr,
                                    (*poses)[static_cast<std::size_t>(t.first)].data(),
                                    (*poses)[static_cast<std::size_t>(t.second)].data());
  }
}

// One loss function for each weight.
class WeightedLoss {
 public:
  explicit WeightedLoss(double sigmas) : cauchy_(sigmas), robust_(sigmas > 0 ? &cauchy_ : nullptr) {}
  ~WeightedLoss() = default;
  WeightedLoss(const WeightedLoss&) = delete;
  WeightedLoss& operator=(const WeightedLoss&) = delete;

  ceres::LossFunction* operator()(double weight) {
    return &losses_.try_emplace(weight, robust_, weight, ceres::DO_NOT_TAKE_OWNERSHIP).first->second;
  }

 private:
  ceres::CauchyLoss cauchy_;
  ceres::LossFunction* const robust_;  // nothing: squares
  std::map<double, ceres::ScaledLoss> losses_;
};

}  // namespace

BundleResult solve_by_ceres(const BundleProblem& problem, const BundleConfig& config) {
  BundleResult result;
  std::vector<Block> poses;
  for (const auto& p : problem.poses) write_block(p.cam_from_world, poses.emplace_back().data());
  result.points = problem.points;

  PoseManifold manifold;
  WeightedLoss weighted(config.loss_sigmas);
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
  std::vector<LensCorrection> lenses(problem.cameras.size());
  ceres::CauchyLoss tails(3);
  for (std::size_t i = 0; i < lenses.size(); ++i) {
    if (!problem.lenses.empty()) lenses[i] = problem.lenses[i].start;
    double* const values = lenses[i].values.data();
    ceres_problem.AddParameterBlock(values, LensCorrection::kTerms);
    ordering->AddElementToGroup(values, 1);
    if (problem.lenses.empty() || !problem.lenses[i].free) {
      ceres_problem.SetParameterBlockConstant(values);
      continue;
    }
    for (int k = 0; k < LensCorrection::kTerms; ++k) {
      ceres_problem.AddResidualBlock(new LensPriorCost(k, problem.lenses[i].prior_sigma[k]), &tails, values);
    }
  }
  for (const auto& o : problem.observations) {
    const auto pose = static_cast<std::size_t>(o.pose);
    const auto of = static_cast<std::size_t>(problem.poses[pose].camera);
    const CameraModel& camera = problem.cameras[of];
    double* const point = result.points[static_cast<std::size_t>(o.point)].data();
    ceres_problem.AddResidualBlock(new LensReprojectionCost(camera, o.undistorted_px, o.sigma_px), weighted(o.weight),
                                   poses[pose].data(), point, lenses[of].values.data());
  }
  add_ties(problem, &poses, &ceres_problem);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (problem.poses[i].fixed) ceres_problem.SetParameterBlockConstant(poses[i].data());
  }
  ceres::Solver::Options options = solver_options(config, problem);
  options.linear_solver_ordering.reset(ordering);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &ceres_problem, &summary);

  result.usable = summary.IsSolutionUsable();
  result.initial_cost = summary.initial_cost;
  result.final_cost = summary.final_cost;
  result.iterations = static_cast<int>(summary.iterations.size());
  if (!problem.lenses.empty()) result.lenses = std::move(lenses);
  for (const Block& b : poses) result.poses.push_back(pose_of(b.data()));
  return result;
}

}  // namespace coslam::test
