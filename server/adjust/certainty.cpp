// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/adjust/certainty.h"

#include <cmath>
#include <map>
#include <tuple>

#include "server/solve/point_uncertainty.h"

namespace coslam {

std::vector<double> worth_of_observations(const RefineJob& job, const std::vector<bool>& counts) {
  std::map<std::tuple<int, CameraId, TrackId>, int> views;
  const auto key = [&](std::size_t i) {
    const auto& o = job.problem.observations[i];
    return std::tuple(o.point, job.poses[static_cast<std::size_t>(o.pose)].camera, job.observations[i].track);
  };
  for (std::size_t i = 0; i < job.observations.size(); ++i) views[key(i)] += counts[i] ? 1 : 0;
  std::vector<double> worth;
  worth.reserve(job.observations.size());
  for (std::size_t i = 0; i < job.observations.size(); ++i) worth.push_back(2.0 / std::max(2, views[key(i)]));
  return worth;
}

std::vector<double> track_variances(const Map& map, const RefineJob& job, const BundleResult& result) {
  constexpr double kSlide2 = 4;    // of a track, over its residual: squared
  constexpr double kPriorDof = 3;  // what is taken for known of each point's residuals: the noise of the image
  struct Residuals {
    double sum2 = 0, noise2 = 0;
    int n = 0;
  };
  std::vector<Residuals> of_points(job.points.size());
  for (std::size_t i = 0; i < job.observations.size(); ++i) {
    if (!result.is_inlier[i]) continue;
    const auto& o = job.problem.observations[i];
    const MapCamera& camera = map.camera(job.poses[static_cast<std::size_t>(o.pose)].camera);
    const double unit_px = map.covariance_sigma_px(camera);
    Residuals& r = of_points[static_cast<std::size_t>(o.point)];
    r.sum2 += std::pow(result.errors_px[i] / unit_px, 2);
    r.noise2 += std::pow(camera.sigma_px / unit_px, 2);
    ++r.n;
  }
  std::vector<double> out;
  out.reserve(of_points.size());
  for (const Residuals& r : of_points) {
    const double noise2 = r.noise2 / std::max(1, r.n), dof = std::max(0, 2 * r.n - 3);
    out.push_back(r.n == 0 ? 1 : noise2 + kSlide2 * (kPriorDof * noise2 + r.sum2) / (kPriorDof + dof));
  }
  return out;
}

namespace {

// In the order of the job. Each track counts for two views.
SolutionUncertainty uncertainty_of_solution(const Map& map, const RefineJob& job, const BundleResult& result) {
  constexpr std::size_t kMostPoses = 200;
  BundleProblem solved = job.problem;
  for (std::size_t i = 0; i < solved.poses.size(); ++i) {
    solved.poses[i].cam_from_world = result.poses[i];
    solved.poses[i].fixed = solved.poses[i].fixed && !job.floating;
  }
  solved.points = result.points;
  const std::vector<double> worth = worth_of_observations(job, result.is_inlier);
  for (std::size_t i = 0; i < solved.observations.size(); ++i) {
    const MapCamera& camera = map.camera(job.poses[static_cast<std::size_t>(solved.observations[i].pose)].camera);
    solved.observations[i].sigma_px = map.covariance_sigma_px(camera) / std::sqrt(worth[i]);
  }
  return uncertainty_of(solved, result.is_inlier, kMostPoses);
}

PathErrors path_errors(const RefineJob& job, const BundleResult& result,
                       const std::vector<std::optional<double>>& centre_variances) {
  struct Sum {
    double variance = 0;
    int known = 0;
    std::optional<Eigen::Vector3d> last;
  };
  std::map<CameraId, Sum> sums;
  PathErrors out;
  for (std::size_t i = 0; i < job.poses.size(); ++i) {
    if (job.problem.poses[i].fixed && !job.floating) continue;
    Sum& sum = sums[job.poses[i].camera];
    PathError& path = out[job.poses[i].camera];
    const Eigen::Vector3d centre = result.poses[i].center();
    if (sum.last) path.length += (centre - *sum.last).norm();
    sum.last = centre;
    if (!centre_variances[i]) continue;
    sum.variance += *centre_variances[i];
    path.sigma = std::sqrt(sum.variance / ++sum.known);
  }
  return out;
}

}  // namespace

PathErrors settle_covariances(MapEdit& edit, const RefineJob& job, const BundleResult& result) {
  const auto variances = track_variances(edit.map(), job, result);
  const auto [share, centre_variances] = uncertainty_of_solution(edit.map(), job, result);
  for (std::size_t i = 0; i < share.size(); ++i) {
    const MapPoint* p = edit.map().find(job.points[i]);
    if (p != nullptr) edit.move_point(*p, p->position, variances[i] * p->covariance + share[i]);
  }
  return path_errors(job, result, centre_variances);
}

}  // namespace coslam
