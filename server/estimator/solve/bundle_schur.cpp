// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/solve/bundle_schur.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "server/estimator/solve/bundle_equations.h"
#include "server/estimator/solve/bundle_reduced.h"

namespace coslam {
namespace {

struct Step {
  Eigen::VectorXd columns;
  std::vector<Eigen::Vector3d> points;
  double decrease = 0;  // of the cost that the system promises
};

std::optional<Step> solve(const BundleStructure& s, const BundleSystem& system, double radius, ReducedSystem* reduced) {
  const auto [dampings, inverse, by_points] = eliminate(s, system, radius);
  Eigen::VectorXd right(6 * s.columns);
  for (int c = 0; c < s.columns; ++c) right.segment<6>(6 * c) = -system.column_gradients[at(c)];
  for (std::size_t l = 0; l < s.links.size(); ++l) {
    const auto point = at(s.links[l].point);
    right.segment<6>(6 * s.links[l].column).noalias() += by_points[l].lazyProduct(system.point_gradients[point]);
  }
  Step step;
  if (s.columns > 0) {
    if (!reduced->factor(system, radius, by_points)) return std::nullopt;
    step.columns = reduced->solve(right);
  }
  step.points.resize(system.points.size());
  for (std::size_t p = 0; p < step.points.size(); ++p) step.points[p] = -inverse[p] * system.point_gradients[p];
  for (std::size_t l = 0; l < s.links.size(); ++l) {
    step.points[at(s.links[l].point)].noalias() -=
        by_points[l].transpose().lazyProduct(step.columns.segment<6>(6 * s.links[l].column));
  }
  // -g d - d H d / 2, where (H + D) d = -g.
  for (int c = 0; c < s.columns; ++c) {
    const Vector6d d = step.columns.segment<6>(6 * c);
    step.decrease +=
        0.5 * d.dot(damping(system.columns[at(c)], radius).cwiseProduct(d) - system.column_gradients[at(c)]);
  }
  for (std::size_t p = 0; p < step.points.size(); ++p) {
    const Eigen::Vector3d& d = step.points[p];
    step.decrease += 0.5 * d.dot(dampings[p].cwiseProduct(d) - system.point_gradients[p]);
  }
  const bool finite = std::isfinite(step.decrease) && step.columns.allFinite();
  return finite ? std::optional(std::move(step)) : std::nullopt;
}

BundleEstimate moved(const BundleProblem& problem, const BundleStructure& s, const BundleEstimate& from,
                     const Step& step) {
  BundleEstimate e = from;
  for (std::size_t i = 0; i < e.poses.size(); ++i) {
    const int column = s.column_of[i];
    if (column < 0) continue;
    e.poses[i] = retract(e.poses[i], step.columns.segment<6>(6 * column));
    e.poses[i].rotation.normalize();
    e.rotations[i] = e.poses[i].rotation.toRotationMatrix();
  }
  for (std::size_t p = 0; p < e.points.size(); ++p) e.points[p] += step.points[p];
  for (std::size_t i = 0; i < e.lenses.size(); ++i) {
    const int column = s.lens_column_of[i];
    if (column < 0) continue;
    LensCorrection lens = e.lenses[i].lens();
    lens.values += step.columns.segment<LensCorrection::kTerms>(6 * column);
    e.lenses[i] = CorrectedLens(problem.cameras[i], lens);
  }
  for (std::size_t i = 0; i < e.zooms.size(); ++i) {
    const auto [column, slot] = s.zoom_of[i];
    if (column >= 0) e.zooms[i] += step.columns[6 * column + slot];
  }
  return e;
}

// Of each free lens, by what all observations say together; empty where it cannot be told.
std::vector<LensMatrix> lens_covariances(const BundleStructure& s, const BundleSystem& system, ReducedSystem* reduced) {
  constexpr double kHardlyDamped = 1e9;  // what nothing holds, as the scale, has no part in a lens
  const Eliminated points = eliminate(s, system, kHardlyDamped);
  if (!reduced->factor(system, kHardlyDamped, points.by_points)) return {};
  std::vector<LensMatrix> out;
  for (const int column : s.lens_column_of) {
    out.emplace_back(LensMatrix::Zero());
    for (int k = 0; column >= 0 && k < LensCorrection::kTerms; ++k) {
      const Eigen::VectorXd solution = reduced->solve(Eigen::VectorXd::Unit(6 * s.columns, 6 * column + k));
      out.back().col(k) = solution.segment<LensCorrection::kTerms>(6 * column);
    }
  }
  return out;
}

}  // namespace

BundleResult solve_by_schur(const BundleProblem& problem, const BundleConfig& config) {
  constexpr double kFirstRadius = 1e5, kLeastRadius = 1e-10, kMostRadius = 1e16, kLeastGain = 1e-3;
  const BundleStructure s = structure_of(problem);
  const BundleLoss loss(config.loss_sigmas);
  BundleEstimate estimate = start_of(problem);
  ReducedSystem reduced(s);
  BundleResult result;
  double cost = cost_of(problem, s, loss, estimate), radius = kFirstRadius, shrink = 2;
  result.initial_cost = cost;
  std::optional<BundleSystem> system;
  bool done = false;
  while (!done && result.iterations < config.max_iterations && radius > kLeastRadius) {
    ++result.iterations;
    if (!system) system = system_around(problem, s, loss, estimate);
    if (const auto step = solve(s, *system, radius, &reduced)) {
      BundleEstimate next = moved(problem, s, estimate, *step);
      const double next_cost = cost_of(problem, s, loss, next);
      const double gain = step->decrease > 0 ? (cost - next_cost) / step->decrease : 0;
      done = std::abs(cost - next_cost) <= config.function_tolerance * cost;
      if (gain > kLeastGain) {
        estimate = std::move(next);
        cost = next_cost;
        system.reset();
        radius = std::min(kMostRadius, radius / std::max(1.0 / 3, 1 - std::pow(2 * gain - 1, 3)));
        shrink = 2;
      } else {
        radius /= std::exchange(shrink, 2 * shrink);
      }
    } else {
      radius /= std::exchange(shrink, 2 * shrink);
    }
    if (config.after_iteration) config.after_iteration(result.iterations);
  }
  result.usable = std::isfinite(cost);
  result.final_cost = cost;
  if (!problem.lenses.empty() && s.columns > 0) {
    result.lens_covariances = lens_covariances(s, system_around(problem, s, loss, estimate), &reduced);
  }
  result.poses = std::move(estimate.poses);
  result.points = std::move(estimate.points);
  for (const CorrectedLens& lens : estimate.lenses) result.lenses.push_back(lens.lens());
  result.zooms = std::move(estimate.zooms);
  return result;
}

}  // namespace coslam
