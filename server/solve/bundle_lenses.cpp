// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/solve/bundle_lenses.h"

#include <ceres/ceres.h>
#include <ceres/normal_prior.h>

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "server/solve/reprojection.h"

namespace coslam {
namespace {

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

// Tells how far the solver is.
class Teller : public ceres::IterationCallback {
 public:
  explicit Teller(const std::function<void(int)>& tell) : tell_(tell) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    if (tell_) tell_(summary.iteration);
    return ceres::SOLVER_CONTINUE;
  }

 private:
  const std::function<void(int)>& tell_;
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

// To be solved for, with what is known of nominal calibrations.
void add_lens(const CameraModel& camera, LensChange& lens, ceres::Problem* problem) {
  const auto sigmas = nominal_lens_sigma(camera);
  problem->AddParameterBlock(lens.values.data(), static_cast<int>(lens.values.size()));
  const ceres::Vector weights = Eigen::Map<const ceres::Vector>(sigmas.data(), std::ssize(sigmas)).cwiseInverse();
  problem->AddResidualBlock(
      new ceres::NormalPrior(ceres::Matrix(weights.asDiagonal()), ceres::Vector::Zero(std::ssize(sigmas))), nullptr,
      lens.values.data());
}

void add_ties(const BundleProblem& problem, std::vector<Block>* poses, ceres::Problem* ceres_problem) {
  for (const auto& t : problem.ties) {
    ceres_problem->AddResidualBlock(make_tie_cost(t.second_from_first).release(), nullptr,
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

BundleResult solve_with_lenses(const BundleProblem& problem, const BundleConfig& config) {
  BundleResult result;
  std::vector<Block> poses;
  for (const auto& p : problem.poses) poses.push_back(to_block(p.cam_from_world));
  result.points = problem.points;

  const std::unique_ptr<ceres::Manifold> manifold = make_pose_manifold();
  WeightedLoss weighted(config.loss_sigmas);
  ceres::Problem::Options ownership;
  ownership.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem ceres_problem(ownership);
  for (Block& b : poses) ceres_problem.AddParameterBlock(b.data(), 7, manifold.get());
  auto* ordering = new ceres::ParameterBlockOrdering;
  for (Block& b : poses) ordering->AddElementToGroup(b.data(), 1);
  for (Eigen::Vector3d& p : result.points) {
    ceres_problem.AddParameterBlock(p.data(), 3);
    ordering->AddElementToGroup(p.data(), 0);
  }
  std::vector<LensChange> lenses = problem.lenses;
  lenses.resize(problem.cameras.size());
  for (std::size_t i = 0; i < lenses.size(); ++i) {
    add_lens(problem.cameras[i], lenses[i], &ceres_problem);
    ordering->AddElementToGroup(lenses[i].values.data(), 1);
    if (problem.lenses.empty()) ceres_problem.SetParameterBlockConstant(lenses[i].values.data());
  }
  for (const auto& o : problem.observations) {
    const auto pose = static_cast<std::size_t>(o.pose);
    const auto of = static_cast<std::size_t>(problem.poses[pose].camera);
    const CameraModel& camera = problem.cameras[of];
    double* const point = result.points[static_cast<std::size_t>(o.point)].data();
    ceres_problem.AddResidualBlock(make_lens_reprojection_cost(camera, o.undistorted_px, o.sigma_px).release(),
                                   weighted(o.weight), poses[pose].data(), point, lenses[of].values.data());
  }
  add_ties(problem, &poses, &ceres_problem);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (problem.poses[i].fixed) ceres_problem.SetParameterBlockConstant(poses[i].data());
  }
  ceres::Solver::Options options = solver_options(config, problem);
  options.linear_solver_ordering.reset(ordering);
  Teller teller(config.after_iteration);
  options.callbacks.push_back(&teller);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &ceres_problem, &summary);

  result.usable = summary.IsSolutionUsable();
  result.initial_cost = summary.initial_cost;
  result.final_cost = summary.final_cost;
  result.iterations = static_cast<int>(summary.iterations.size());
  if (!problem.lenses.empty()) result.lenses = std::move(lenses);
  for (const Block& b : poses) result.poses.push_back(from_block(b));
  return result;
}

}  // namespace coslam
