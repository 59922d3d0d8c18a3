// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/solve/path_uncertainty.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "server/estimator/solve/bundle_equations.h"
#include "server/estimator/solve/bundle_reduced.h"
#include "server/estimator/solve/reprojection.h"

namespace coslam {
namespace {

constexpr int kDraws = 100;
constexpr double kHardlyDamped = 1e14;

using Draws6 = Eigen::Matrix<double, 6, kDraws>;
using Draws3 = Eigen::Matrix<double, 3, kDraws>;

// The part of a problem that tells its poses: points that two of them see, poses that see enough of these.
class Telling {
 public:
  Telling(const BundleProblem& problem, std::vector<bool> use) : use_(std::move(use)) {
    constexpr int kLeastViews = 2;
    // Without a point another pose may see too little, and so on.
    for (bool changed = true; changed;) {
      std::vector<int> views(problem.points.size()), points(problem.poses.size());
      each(problem, [&](const auto& o) { ++views[at(o.point)], ++points[at(o.pose)]; });
      changed = false;
      for (std::size_t i = 0; i < use_.size(); ++i) {
        const auto& o = problem.observations[i];
        if (!use_[i] || (views[at(o.point)] >= kLeastViews && points[at(o.pose)] >= kLeastPointsOfPose)) continue;
        use_[i] = false;
        changed = true;
      }
    }
  }
  BundleProblem problem(const BundleProblem& original) const {
    BundleProblem out{.cameras = original.cameras, .lenses = {}, .poses = original.poses, .points = original.points};
    std::vector<bool> sees(original.poses.size());
    each(original, [&](const auto& o) {
      out.observations.push_back(o);
      out.observations.back().weight = 1;
      sees[at(o.pose)] = true;
    });
    for (std::size_t i = 0; i < sees.size(); ++i) out.poses[i].fixed = out.poses[i].fixed || !sees[i];
    return out;
  }

 private:
  void each(const BundleProblem& problem, auto&& visit) const {
    for (std::size_t i = 0; i < use_.size(); ++i) {
      if (use_[i]) visit(problem.observations[i]);
    }
  }

  std::vector<bool> use_;
};

// J^T z of every column and every point.
struct DrawnGradients {
  std::vector<Draws6> columns;
  std::vector<Draws3> points;
};

DrawnGradients draw(const BundleProblem& problem, const BundleStructure& s, const BundleEstimate& e) {
  DrawnGradients out{std::vector<Draws6>(at(s.columns), Draws6::Zero()),
                     std::vector<Draws3>(problem.points.size(), Draws3::Zero())};
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  Eigen::Matrix<double, 2, kDraws> z;
  for (std::size_t i = 0; i < problem.observations.size(); ++i) {
    const auto& o = problem.observations[i];
    const auto& camera = problem.cameras[at(problem.poses[at(o.pose)].camera)];
    const Reprojection r = reprojection(camera, s.whiten[i], o.undistorted_px, e.rotations[at(o.pose)],
                                        e.poses[at(o.pose)].translation, e.points[at(o.point)]);
    for (double& coefficient : z.reshaped()) coefficient = normal(random);
    out.points[at(o.point)].noalias() += r.by_point.transpose() * z;
    const int column = s.column_of[at(o.pose)];
    if (column >= 0) out.columns[at(column)].noalias() += r.by_pose.transpose() * z;
  }
  return out;
}

// How the translation of a pose changes when the whole map does a little: shifted, turned, scaled.
Eigen::Matrix<double, 3, kGaugeFreedoms> centre_gauge_motion(const Rigid3& cam_from_world) {
  const Eigen::Matrix3d r = cam_from_world.rotation.toRotationMatrix();
  Eigen::Matrix<double, 3, kGaugeFreedoms> n;
  n << r, skew(cam_from_world.translation) * r, cam_from_world.translation;
  return n;
}

// Takes out what a similarity of the whole map would do: least squares over all centres. by_column: draws of each
// pose's six local coordinates, of which the last three move its centre.
void align(const BundleProblem& problem, const BundleStructure& s, Eigen::MatrixXd* draws) {
  Eigen::Matrix<double, kGaugeFreedoms, kGaugeFreedoms> normal =
      Eigen::Matrix<double, kGaugeFreedoms, kGaugeFreedoms>::Zero();
  Eigen::Matrix<double, kGaugeFreedoms, kDraws> right = Eigen::Matrix<double, kGaugeFreedoms, kDraws>::Zero();
  const auto each = [&](auto&& visit) {
    for (std::size_t i = 0; i < problem.poses.size(); ++i) {
      const int column = s.column_of[i];
      if (column >= 0) visit(centre_gauge_motion(problem.poses[i].cam_from_world), 6 * column + 3);
    }
  };
  each([&](const auto& motion, int row) {
    normal += motion.transpose() * motion;
    right += motion.transpose() * draws->middleRows<3>(row);
  });
  const Eigen::Matrix<double, kGaugeFreedoms, kDraws> change = normal.completeOrthogonalDecomposition().solve(right);
  each([&](const auto& motion, int row) { draws->middleRows<3>(row) -= motion * change; });
}

// Of all solutions that fit as well as each other, the one in which a pose stays and so does the distance of the centre
// farthest from it: that takes nothing from the rest, and align() takes it out again.
void hold_gauge(const BundleProblem& problem, const BundleStructure& s, BundleSystem* system) {
  std::vector<std::size_t> free;
  for (std::size_t i = 0; i < problem.poses.size(); ++i) {
    if (s.column_of[i] >= 0) free.push_back(i);
  }
  const std::size_t stays = free[free.size() / 2];
  const Eigen::Vector3d centre = problem.poses[stays].cam_from_world.center();
  const auto distance = [&](std::size_t i) { return (problem.poses[i].cam_from_world.center() - centre).norm(); };
  const std::size_t far = *std::ranges::max_element(free, {}, distance);
  system->columns[at(s.column_of[stays])] *= 2;
  const Eigen::Vector3d along = (problem.poses[far].cam_from_world * centre).normalized();  // scale, as it sees it
  auto block = system->columns[at(s.column_of[far])].bottomRightCorner<3, 3>();
  block += block.trace() * along * along.transpose();
}

// floats: nothing holds the map where it is.
std::vector<std::optional<double>> variances_of(const BundleProblem& problem, bool floats) {
  std::vector<std::optional<double>> out(problem.poses.size());
  const BundleStructure s = structure_of(problem);
  if (s.columns < 2) return out;
  const BundleEstimate estimate = start_of(problem);
  BundleSystem system = system_around(problem, s, BundleLoss(0), estimate);
  if (floats) hold_gauge(problem, s, &system);

  const std::vector<Matrix63> by_points = eliminate(s, system, kHardlyDamped).by_points;
  ReducedSystem reduced(s);
  if (!reduced.factor(system, kHardlyDamped, by_points)) return out;

  const DrawnGradients gradients = draw(problem, s, estimate);
  Eigen::MatrixXd draws(6 * s.columns, kDraws);
  for (int c = 0; c < s.columns; ++c) draws.middleRows<6>(6 * c) = -gradients.columns[at(c)];
  for (std::size_t l = 0; l < s.links.size(); ++l) {
    draws.middleRows<6>(6 * s.links[l].column) += by_points[l] * gradients.points[at(s.links[l].point)];
  }
  for (int k = 0; k < kDraws; ++k) draws.col(k) = reduced.solve(draws.col(k));
  if (!draws.allFinite()) return out;
  if (floats) align(problem, s, &draws);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const int column = s.column_of[i];
    if (column >= 0) out[i] = draws.middleRows<3>(6 * column + 3).squaredNorm() / kDraws;
  }
  return out;
}

}  // namespace

std::vector<bool> agreeing(const BundleProblem& problem, double sigmas) {
  std::vector<bool> out;
  out.reserve(problem.observations.size());
  for (const auto& o : problem.observations) {
    const auto& pose = problem.poses[at(o.pose)];
    const CameraModel& camera = problem.cameras[at(pose.camera)];
    const Eigen::Matrix2d whiten = camera.raw_by_undistorted(o.undistorted_px) / o.sigma_px;
    const Eigen::Vector3d in_cam = pose.cam_from_world * problem.points[at(o.point)];
    out.push_back(in_cam.z() > 0 && reprojection_residual(camera, whiten, o.undistorted_px, in_cam).norm() <= sigmas);
  }
  return out;
}

std::vector<std::optional<double>> centre_variances(const BundleProblem& problem, const std::vector<bool>& use) {
  const bool floats = std::ranges::none_of(problem.poses, &BundleProblem::Pose::fixed);
  return variances_of(Telling(problem, use).problem(problem), floats);
}

}  // namespace coslam
