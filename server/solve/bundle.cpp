// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/solve/bundle.h"

#include "common/geometry/robust.h"
#include "server/solve/bundle_schur.h"

namespace coslam {
namespace {

void judge_observations(const BundleProblem& problem, const BundleConfig& config, BundleResult* result) {
  std::vector<CorrectedLens> lenses;
  for (std::size_t i = 0; i < result->lenses.size(); ++i) lenses.emplace_back(problem.cameras[i], result->lenses[i]);
  std::vector<double> norms_px;
  result->is_inlier.resize(problem.observations.size());
  for (std::size_t i = 0; i < problem.observations.size(); ++i) {
    const auto& o = problem.observations[i];
    const Eigen::Vector3d x =
        result->poses[static_cast<std::size_t>(o.pose)] * result->points[static_cast<std::size_t>(o.point)];
    if (x.z() < 1e-4) continue;
    const auto camera = static_cast<std::size_t>(problem.poses[static_cast<std::size_t>(o.pose)].camera);
    const CameraModel& model = problem.cameras[camera];
    const double error_px =
        lenses.empty()
            ? (model.raw_by_undistorted(o.undistorted_px) * (model.project(x) - o.undistorted_px)).norm()
            : (lenses[camera].raw_from_normalized(x.hnormalized()) - model.raw_from_undistorted(o.undistorted_px))
                  .norm();
    norms_px.push_back(error_px);
    result->is_inlier[i] = error_px <= config.outlier_sigmas * o.sigma_px;
  }
  result->sigma_px = robust_sigma_2d(norms_px);
}

}  // namespace

BundleResult solve_bundle(const BundleProblem& problem, const BundleConfig& config) {
  BundleResult result = solve_by_schur(problem, config);
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
  s.scale = before.ties.empty() ? old_length / new_length : 1.0;
  s.rotation = (before.poses[a].cam_from_world.rotation.conjugate() * result->poses[a].rotation).normalized();
  s.translation = before.poses[a].cam_from_world.center() - s.scale * (s.rotation * result->poses[a].center());
  for (Rigid3& p : result->poses) p = transform_world(p, s);
  for (Eigen::Vector3d& p : result->points) p = s * p;
}

}  // namespace coslam
