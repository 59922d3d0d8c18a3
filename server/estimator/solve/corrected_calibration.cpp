// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/solve/corrected_calibration.h"

#include <ceres/dynamic_numeric_diff_cost_function.h>
#include <ceres/solver.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace coslam {
namespace {

using Seen = std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>>;  // normalized, raw px

CameraModel with_terms(const CameraModel& camera, const double* terms) {
  CameraModel out = camera;
  out.fx = terms[0];
  out.fy = terms[1];
  out.cx = terms[2];
  out.cy = terms[3];
  const LensTraits& lens = lens_traits(camera.distortion);
  for (std::size_t i = lens.first_free; i < lens.end_free; ++i) out.coefficients[i] = terms[4 + i - lens.first_free];
  return out;
}

Eigen::Vector2d miss_px(const CameraModel& camera, const Seen::value_type& seen) {
  return camera.pixel_from_normalized(camera.distort_normalized(seen.first)) - seen.second;
}

struct Misses {
  const CameraModel& camera;
  const Seen& seen;
  bool operator()(double const* const* terms, double* residuals) const {
    const CameraModel now = with_terms(camera, terms[0]);
    for (std::size_t i = 0; i < seen.size(); ++i) {
      Eigen::Map<Eigen::Vector2d>{residuals + 2 * i} = miss_px(now, seen[i]);
    }
    return true;
  }
};

Seen all_over_the_image(const CameraModel& camera, const LensCorrection& lens) {
  constexpr int kAcross = 16, kDown = 12;
  Seen out;
  for (int i = 0; i <= kAcross; ++i) {
    for (int j = 0; j <= kDown; ++j) {
      const Eigen::Vector2d raw_px(i * (camera.width_px - 1.0) / kAcross, j * (camera.height_px - 1.0) / kDown);
      if (const auto n = lens.normalized_from_raw(camera, raw_px)) out.emplace_back(*n, raw_px);
    }
  }
  return out;
}

}  // namespace

CorrectedCalibration corrected_calibration(const CameraModel& camera, const LensCorrection& lens) {
  if (lens.none()) return {camera, 0};
  const Seen seen = all_over_the_image(camera, lens);
  CameraModel start = camera;
  const bool pinhole = lens_traits(camera.distortion).end_free == 0;
  if (pinhole) start.distortion = DistortionModel::kRadTan;
  std::vector<double> terms{camera.fx, camera.fy, camera.cx, camera.cy};
  const LensTraits& traits = lens_traits(start.distortion);
  for (std::size_t i = traits.first_free; i < traits.end_free; ++i) terms.push_back(start.coefficients[i]);
  auto* cost = new ceres::DynamicNumericDiffCostFunction<Misses, ceres::CENTRAL>(new Misses{start, seen});
  cost->AddParameterBlock(static_cast<int>(terms.size()));
  cost->SetNumResiduals(static_cast<int>(2 * seen.size()));
  ceres::Problem problem;
  problem.AddResidualBlock(cost, nullptr, terms.data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = 100;
  options.function_tolerance = 1e-12;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  CorrectedCalibration out{with_terms(start, terms.data()), 0};
  for (const auto& s : seen) out.worst_px = std::max(out.worst_px, miss_px(out.camera, s).norm());
  return out;
}

}  // namespace coslam
