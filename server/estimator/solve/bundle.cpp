// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/solve/bundle.h"

#include <cmath>
#include <limits>

#include "common/geometry/alignment.h"
#include "common/geometry/robust.h"
#include "server/estimator/solve/bundle_schur.h"

namespace coslam {
namespace {

void judge_observations(const BundleProblem& problem, const BundleConfig& config, BundleResult* result) {
  std::vector<CorrectedLens> lenses;
  for (std::size_t i = 0; i < result->lenses.size(); ++i) lenses.emplace_back(problem.cameras[i], result->lenses[i]);
  std::vector<double> norms_px;
  result->is_inlier.resize(problem.observations.size());
  result->errors_px.resize(problem.observations.size(), std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < problem.observations.size(); ++i) {
    const auto& o = problem.observations[i];
    const Eigen::Vector3d x =
        result->poses[static_cast<std::size_t>(o.pose)] * result->points[static_cast<std::size_t>(o.point)];
    if (x.z() < 1e-4) continue;
    const auto camera = static_cast<std::size_t>(problem.poses[static_cast<std::size_t>(o.pose)].camera);
    const CameraModel& model = problem.cameras[camera];
    const Eigen::Vector2d centre = lenses.empty()
                                       ? Eigen::Vector2d::Zero().eval()
                                       : Eigen::Vector2d(model.cx, model.cy) + lenses[camera].lens().centre_px();
    const double zoom = result->zooms.empty() ? 0 : result->zooms[static_cast<std::size_t>(o.pose)];
    const double error_px =
        lenses.empty() ? (model.raw_by_undistorted(o.undistorted_px) * (model.project(x) - o.undistorted_px)).norm()
                       : (centre + std::exp(zoom) * (lenses[camera].raw_from_normalized(x.hnormalized()) - centre) -
                          model.raw_from_undistorted(o.undistorted_px))
                             .norm();
    norms_px.push_back(error_px);
    result->errors_px[i] = error_px;
    result->is_inlier[i] = error_px <= config.outlier_sigmas * o.sigma_px;
  }
  result->sigma_px = robust_sigma_2d(norms_px);
}

// A cloud that lies and is turned as poses are: their centres, and places before and below each, as far off as the
// centres lie from each other.
std::vector<Eigen::Vector3d> placed(const std::vector<Rigid3>& cam_from_world) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Rigid3& p : cam_from_world) mean += p.center() / static_cast<double>(cam_from_world.size());
  double spread2 = 0;
  for (const Rigid3& p : cam_from_world) spread2 += (p.center() - mean).squaredNorm();
  const double reach = std::sqrt(spread2 / static_cast<double>(cam_from_world.size()));
  std::vector<Eigen::Vector3d> out;
  out.reserve(3 * cam_from_world.size());
  for (const Rigid3& p : cam_from_world) {
    const Rigid3 world_from_cam = p.inverse();
    for (const Eigen::Vector3d& in_cam :
         {Eigen::Vector3d::Zero().eval(), Eigen::Vector3d(0, 0, reach), Eigen::Vector3d(0, reach, 0)}) {
      out.push_back(world_from_cam * in_cam);
    }
  }
  return out;
}

void transform(const Similarity3& new_from_old, BundleResult* result) {
  for (Rigid3& p : result->poses) p = transform_world(p, new_from_old);
  for (Eigen::Vector3d& p : result->points) p = new_from_old * p;
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
  transform(s, result);
}

void put_back(const BundleProblem& before, BundleResult* result) {
  std::vector<Rigid3> poses;
  for (const BundleProblem::Pose& p : before.poses) poses.push_back(p.cam_from_world);
  const Alignment back = align_points(placed(result->poses), placed(poses),
                                      before.ties.empty() ? AlignmentScale::kFree : AlignmentScale::kFixed);
  if (back.target_from_source) transform(*back.target_from_source, result);
}

}  // namespace coslam
