// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/export/colmap_adjust.h"

#include <algorithm>
#include <map>

#include "common/geometry/alignment.h"
#include "common/geometry/robust.h"
#include "server/estimator/solve/bundle.h"

namespace coslam::exporting {
namespace {

constexpr double kLeastSigma_px = 0.5;

// As the estimator has it: observations beyond are outliers.
double gate_px(const ColmapModel& model) {
  constexpr double kGate_sigmas = 4;
  std::vector<double> errors_px;
  for (const auto& [id, point] : model.points) {
    for (const auto& e : point.track) errors_px.push_back(error_px(model, point, e));
  }
  return kGate_sigmas * std::max(kLeastSigma_px, robust_sigma_2d(errors_px));
}

BundleProblem problem_of(const ColmapModel& model) {
  BundleProblem problem;
  for (const auto& camera : model.cameras) problem.cameras.push_back(camera.model);
  for (const auto& image : model.images)
    problem.poses.push_back({image.cam_from_world, static_cast<int>(image.camera), problem.poses.empty()});
  for (const auto& [id, point] : model.points) {
    for (const auto& e : point.track) {
      const auto& image = model.images[e.image];
      const auto px = model.camera_of(image).undistorted_from_raw(image.observations[e.observation].px);
      if (!px) continue;
      problem.observations.push_back(
          {static_cast<int>(e.image), static_cast<int>(problem.points.size()), *px, kLeastSigma_px, 1.0});
    }
    problem.points.push_back(point.position);
  }
  return problem;
}

// Where cameras are and to where they look, so that a straight path tells the turn about it too. As far out as the
// cameras are from each other, for the solution is free to change the scale of all.
std::vector<Eigen::Vector3d> gauge_marks(const std::vector<Rigid3>& poses) {
  double reach = 0;
  for (const Rigid3& pose : poses) reach = std::max(reach, (pose.center() - poses.front().center()).norm());
  std::vector<Eigen::Vector3d> marks;
  for (const Rigid3& cam_from_world : poses) {
    const Rigid3 world_from_cam = cam_from_world.inverse();
    for (const Eigen::Vector3d& p :
         {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(reach, 0, 0), Eigen::Vector3d(0, 0, reach)})
      marks.emplace_back(world_from_cam * p);
  }
  return marks;
}

std::vector<Rigid3> poses_of(const ColmapModel& model) {
  std::vector<Rigid3> poses;
  for (const auto& image : model.images) poses.push_back(image.cam_from_world);
  return poses;
}

// Moves the model as a whole to where these poses of it were.
void restore_gauge(const std::vector<Rigid3>& before, ColmapModel* model) {
  const auto aligned =
      align_points(gauge_marks(poses_of(*model)), gauge_marks(before), AlignmentScale::kFree).target_from_source;
  if (!aligned) return;
  for (auto& image : model->images) image.cam_from_world = transform_world(image.cam_from_world, *aligned);
  for (auto& [id, point] : model->points) point.position = *aligned * point.position;
}

// False: the solver found nothing better.
bool solve(double loss_sigmas, ColmapModel* model) {
  const BundleProblem problem = problem_of(*model);
  const BundleResult result =
      solve_bundle(problem, {.max_iterations = 100, .function_tolerance = 1e-7, .loss_sigmas = loss_sigmas});
  if (!result.usable) return false;
  const std::vector<Rigid3> before = poses_of(*model);
  for (std::size_t i = 0; i < result.poses.size(); ++i) model->images[i].cam_from_world = result.poses[i];
  auto position = result.points.begin();
  for (auto& [id, point] : model->points) point.position = *position++;
  restore_gauge(before, model);
  return true;
}

bool drop_outliers(double most_px, ColmapModel* model) {
  bool any = false;
  for (const auto& [id, point] : model->points) {
    for (const auto& e : point.track) {
      if (error_px(*model, point, e) <= most_px) continue;
      model->images[e.image].observations[e.observation].point = PointId();
      any = true;
    }
  }
  link_points(model);
  return any;
}

}  // namespace

void adjust_colmap_model(ColmapModel* model) {
  constexpr double kRobust_sigmas = 2, kSquares = 0;
  constexpr int kMostRounds = 5;
  if (model->images.size() < 2 || !solve(kRobust_sigmas, model)) return;
  const double most_px = gate_px(*model);
  drop_outliers(most_px, model);
  for (int round = 0; round < kMostRounds && model->images.size() >= 2; ++round) {
    if (!solve(kSquares, model) || !drop_outliers(most_px, model)) return;
  }
}

}  // namespace coslam::exporting
