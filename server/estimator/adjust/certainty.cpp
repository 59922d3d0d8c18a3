// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/adjust/certainty.h"

#include <cmath>
#include <map>
#include <tuple>

#include "server/estimator/solve/path_uncertainty.h"
#include "server/estimator/solve/point_uncertainty.h"

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

// What a job's observations are worth for covariances: each track counts for two views.
void weigh_for_covariances(const Map& map, const std::vector<bool>& counts, RefineJob* job) {
  const std::vector<double> worth = worth_of_observations(*job, counts);
  for (std::size_t i = 0; i < worth.size(); ++i) {
    BundleProblem::Observation& o = job->problem.observations[i];
    const MapCamera& camera = map.camera(job->poses[static_cast<std::size_t>(o.pose)].camera);
    o.sigma_px = map.covariance_sigma_px(camera) / std::sqrt(worth[i]);
  }
}

// As it is solved, for covariances.
RefineJob solved_job(const Map& map, const RefineJob& job, const BundleResult& result) {
  RefineJob solved = job;
  for (std::size_t i = 0; i < solved.poses.size(); ++i) {
    solved.problem.poses[i].cam_from_world = result.poses[i];
    solved.problem.poses[i].fixed = solved.problem.poses[i].fixed && !job.floating;
  }
  solved.problem.points = result.points;
  weigh_for_covariances(map, result.is_inlier, &solved);
  return solved;
}

PathErrors path_errors(const RefineJob& solved, const std::vector<bool>& use) {
  struct Sum {
    double variance = 0;
    int known = 0;
    std::optional<Eigen::Vector3d> last;
  };
  const auto variances = centre_variances(solved.problem, use);
  std::map<CameraId, Sum> sums;
  PathErrors out;
  for (std::size_t i = 0; i < solved.poses.size(); ++i) {
    if (solved.problem.poses[i].fixed) continue;
    Sum& sum = sums[solved.poses[i].camera];
    PathError& path = out[solved.poses[i].camera];
    const Eigen::Vector3d centre = solved.problem.poses[i].cam_from_world.center();
    if (sum.last) path.length += (centre - *sum.last).norm();
    sum.last = centre;
    if (!variances[i]) continue;
    sum.variance += *variances[i];
    path.sigma = std::sqrt(sum.variance / ++sum.known);
  }
  for (auto& [camera, path] : out) {
    if (path.sigma && !(*path.sigma < path.length)) path.sigma.reset();
  }
  return out;
}

}  // namespace

PathErrors settle_covariances(PointPositionEdit& edit, const RefineJob& job, const BundleResult& result) {
  constexpr std::size_t kMostPoses = 200;
  const auto variances = track_variances(edit.map(), job, result);
  const RefineJob solved = solved_job(edit.map(), job, result);
  const auto share = share_of_poses(solved.problem, result.is_inlier, kMostPoses);
  for (std::size_t i = 0; i < share.size(); ++i) {
    const MapPoint* p = edit.map().find(job.points[i]);
    if (p != nullptr) edit.move_point(*p, p->position, variances[i] * p->covariance + share[i]);
  }
  return path_errors(solved, result.is_inlier);
}

std::optional<RefineJob> plan_path_errors(const Map& map, MapId map_id) {
  constexpr int kMostPoses = 1500;
  auto job = plan_newest(map, map_id, kMostPoses);
  if (!job) return job;
  for (BundleProblem::Pose& pose : job->problem.poses) pose.fixed = false;
  weigh_for_covariances(map, std::vector<bool>(job->observations.size(), true), &*job);
  return job;
}

PathErrors path_errors(const RefineJob& job) {
  return path_errors(job, agreeing(job.problem, job.config.outlier_sigmas));
}

}  // namespace coslam
