// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/adjust/lens.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

namespace coslam {
namespace {

// Squared distance from the calibration in standard deviations. Simulated rooms, whose calibrations are right, come to
// 8 at most; what recordings get wrong, to 40 and more.
constexpr double kFound2 = 12;
constexpr double kLensTolerance = 1e-5;  // relative change of the cost that ends a solution

// How far a camera's lens was found from another: squared, in standard deviations; 0 where that is not known.
double step2(const BundleResult& found, std::size_t i, const LensCorrection& from) {
  if (found.lens_covariances.empty()) return 0;
  const LensCorrection::Values step = found.lenses[i].values - from.values;
  return step.dot(found.lens_covariances[i].ldlt().solve(step));
}

// Each camera whose lens is as calibrated so far and is not found elsewhere now: given.
void give_what_is_right(const BundleResult& found, BundleProblem* problem) {
  for (std::size_t i = 0; i < problem->lenses.size(); ++i) {
    BundleProblem::Lens& lens = problem->lenses[i];
    if (!lens.free || !lens.start.none()) continue;
    const bool wrong = step2(found, i, {}) > kFound2;
    if (wrong && may_be(problem->cameras[i], found.lenses[i])) continue;
    lens.free = false;
  }
}

}  // namespace

LensCorrection::Values calibration_sigma(const CameraModel& camera) {
  struct Worth {
    double focal, centre, aspect, tangential, radial;
  };
  constexpr Worth kCalibration{0.005, 0.005, 0.002, 0.001, 0.01}, kGuess{0.3, 0.015, 0.005, 0.002, 0.2};
  const Worth& worth = camera.guessed() ? kGuess : kCalibration;
  const double centre_px = worth.centre * camera.width_px;
  LensCorrection::Values out;
  out.head<6>() << worth.focal, centre_px, centre_px, worth.aspect, worth.tangential, worth.tangential;
  for (int j = 0; j < LensCorrection::kRadial; ++j) out[6 + j] = worth.radial / std::pow(2.0, j);
  return out;
}

void free_lenses(const Map& map, RefineJob* job) {
  // Lenses lie in long valleys of the cost: where poses and points are done, they are still on their way.
  job->config.function_tolerance = kLensTolerance;
  // With next to no observations a lens that was found would go back to its calibration.
  constexpr int kFewest = 200;
  std::vector<int> seen(map.cameras().size());
  for (const auto& o : job->problem.observations) ++seen[job->poses[static_cast<std::size_t>(o.pose)].camera.value];
  for (const MapCamera& c : map.cameras()) {
    job->problem.lenses.push_back({c.lens, calibration_sigma(c.model), seen[c.id.value] >= kFewest});
  }
  for (auto& o : job->problem.observations) {
    const MapCamera& c = map.camera(job->poses[static_cast<std::size_t>(o.pose)].camera);
    if (const auto px = c.lens.calibrated_from_undistorted(c.model, o.undistorted_px)) {
      o.undistorted_px = *px;
    } else {
      o.weight = 0;
    }
  }
}

void go_on(const BundleResult& from, BundleProblem* problem) {
  for (std::size_t i = 0; i < problem->poses.size(); ++i) problem->poses[i].cam_from_world = from.poses[i];
  for (std::size_t i = 0; i < problem->lenses.size(); ++i) {
    const bool may = problem->lenses[i].free && may_be(problem->cameras[i], from.lenses[i]);
    if (may) problem->lenses[i].start = from.lenses[i];
  }
  problem->points = from.points;
}

namespace {

// A map that was made through a wrong lens contradicts the right one by many pixels here and there, which a loss that
// is made for outliers does not even feel. With a wide one all pull, before it is narrowed again.
BundleResult solve_from_afar(BundleProblem problem, const BundleConfig& config) {
  constexpr double kWide = 10;
  BundleConfig wide = config;
  wide.loss_sigmas *= kWide;
  const BundleResult result = solve_bundle(problem, wide);
  if (result.usable) go_on(result, &problem);
  return solve_bundle(problem, config);
}

}  // namespace

BundleResult solve_with_lenses(const RefineJob& job) {
  BundleProblem problem = job.problem;
  const auto any = [&](auto&& holds) { return std::ranges::any_of(problem.lenses, holds); };
  if (!any(&BundleProblem::Lens::free)) return solve_bundle(problem, job.config);
  if (any([](const auto& lens) { return lens.free && lens.start.none(); })) {
    BundleResult found = solve_bundle(problem, job.config);
    if (!found.usable) return found;
    give_what_is_right(found, &problem);
    if (!any(&BundleProblem::Lens::free)) {
      go_on(found, &problem);
      return solve_bundle(problem, job.config);
    }
  }
  return solve_from_afar(std::move(problem), job.config);
}

namespace {

// Another lens than the camera has now, and one that can be used. The agent may have come back with another
// calibration.
bool is_new(const MapCamera& c, const RefineJob& job, const BundleResult& result) {
  const std::size_t i = c.id.value;
  const bool same = c.model == job.problem.cameras[i] && c.lens == job.problem.lenses[i].start;
  return same && !(result.lenses[i] == c.lens) && may_be(c.model, result.lenses[i]);
}

}  // namespace

double lens_step2(const Map& map, const RefineJob& job, const BundleResult& result) {
  double most2 = 0;
  for (std::size_t i = 0; i < result.lenses.size(); ++i) {
    const MapCamera& c = map.camera(CameraId(static_cast<std::uint16_t>(i)));
    if (is_new(c, job, result)) most2 = std::max(most2, step2(result, i, c.lens));
  }
  return most2;
}

bool lenses_may_be_taken(const Map& map, const RefineJob& job, const BundleResult& result) {
  return std::ranges::all_of(map.cameras(), [&](const MapCamera& c) {
    const std::size_t i = c.id.value;
    return i >= result.lenses.size() || result.lenses[i] == c.lens || is_new(c, job, result);
  });
}

int take_lenses(BundleEdit& edit, const RefineJob& job, const BundleResult& result) {
  int changed = 0;
  for (std::size_t i = 0; i < result.lenses.size(); ++i) {
    const MapCamera& c = edit.map().camera(CameraId(static_cast<std::uint16_t>(i)));
    if (!is_new(c, job, result)) continue;
    LensCorrection::Values sigma = LensCorrection::Values::Zero();
    if (!result.lens_covariances.empty()) sigma = result.lens_covariances[i].diagonal().cwiseMax(0).cwiseSqrt();
    edit.correct_lens(c, result.lenses[i], sigma);
    ++changed;
  }
  return changed;
}

}  // namespace coslam
