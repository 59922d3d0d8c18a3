// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/solve/point_uncertainty.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <utility>

#include "common/geometry/rigid3.h"

namespace coslam {
namespace {

using Matrix63 = Eigen::Matrix<double, 6, 3>;

// All of one point: its diagonal block and its coupling to each pose.
struct PointBlocks {
  Eigen::Matrix3d block = Eigen::Matrix3d::Zero();
  std::vector<std::pair<int, Matrix63>> coupling;  // index of a chosen pose
};

// Position of each pose among those that take part; -1 for the others.
std::vector<int> choose(const BundleProblem& problem, std::size_t most) {
  std::vector<std::size_t> free;
  for (std::size_t i = 0; i < problem.poses.size(); ++i) {
    if (!problem.poses[i].fixed) free.push_back(i);
  }
  std::vector<int> index(problem.poses.size(), -1);
  const std::size_t n = std::min(most, free.size());
  for (std::size_t k = 0; k < n; ++k) index[free[k * free.size() / n]] = static_cast<int>(k);
  return index;
}

// Small motions of the whole map as seen by one pose: how its six local coordinates change.
Eigen::Matrix<double, 6, kGaugeFreedoms> gauge_motion(const Rigid3& cam_from_world) {
  const Eigen::Matrix3d r = cam_from_world.rotation.toRotationMatrix();
  Eigen::Matrix<double, 6, kGaugeFreedoms> n = Eigen::Matrix<double, 6, kGaugeFreedoms>::Zero();
  n.block<3, 3>(3, 0) = r;
  n.block<3, 3>(0, 3) = r;
  n.block<3, 3>(3, 3) = skew(cam_from_world.translation) * r;
  n.block<3, 1>(3, 6) = cam_from_world.translation;
  return n;
}

// Inverse of the poses' information in the frame in which the centres stay put as a whole.
Eigen::MatrixXd pose_covariance(Eigen::MatrixXd information, const BundleProblem& problem,
                                const std::vector<int>& index, bool floats) {
  if (floats) {
    Eigen::MatrixXd constraint = Eigen::MatrixXd::Zero(information.rows(), kGaugeFreedoms);
    for (std::size_t i = 0; i < index.size(); ++i) {
      if (index[i] < 0) continue;
      auto rows = constraint.middleRows<6>(6 * index[i]);
      rows = gauge_motion(problem.poses[i].cam_from_world);
      rows.topRows<3>().setZero();  // centres only
    }
    const Eigen::MatrixXd q = Eigen::HouseholderQR<Eigen::MatrixXd>(constraint).householderQ() *
                              Eigen::MatrixXd::Identity(information.rows(), kGaugeFreedoms);
    information += 1e3 * information.diagonal().maxCoeff() * q * q.transpose();
  }
  information.diagonal().array() *= 1 + 1e-12;
  return information.llt().solve(Eigen::MatrixXd::Identity(information.rows(), information.cols()));
}

// Leaves the points out of the poses' information. The inverse of each point's own block; one that is not known, or
// coupled to one pose alone, says nothing of poses.
std::vector<Eigen::Matrix3d> eliminate(std::vector<PointBlocks>* blocks, Eigen::MatrixXd* information) {
  std::vector<Eigen::Matrix3d> own_inverse(blocks->size(), Eigen::Matrix3d::Zero());
  for (std::size_t p = 0; p < blocks->size(); ++p) {
    PointBlocks& b = (*blocks)[p];
    bool known = false;
    b.block.computeInverseWithCheck(own_inverse[p], known, 1e-30);
    if (!known || b.coupling.size() < 2) {
      b.coupling.clear();
      continue;
    }
    for (const auto& [i, wi] : b.coupling) {
      const Matrix63 left = wi * own_inverse[p];
      for (const auto& [j, wj] : b.coupling) information->block<6, 6>(6 * i, 6 * j) -= left * wj.transpose();
    }
  }
  return own_inverse;
}

Eigen::Matrix3d share_of(const PointBlocks& b, const Eigen::Matrix3d& own_inverse, const Eigen::MatrixXd& covariance) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const auto& [i, wi] : b.coupling) {
    for (const auto& [j, wj] : b.coupling) {
      sum += wi.transpose() * covariance.block<6, 6>(6 * i, 6 * j) * wj;
    }
  }
  return own_inverse * sum * own_inverse;
}

}  // namespace

std::vector<Eigen::Matrix3d> share_of_poses(const BundleProblem& problem, const std::vector<bool>& use,
                                            std::size_t max_poses) {
  std::vector<Eigen::Matrix3d> out(problem.points.size(), Eigen::Matrix3d::Zero());
  const std::vector<int> index = choose(problem, max_poses);
  const int n = 1 + *std::max_element(index.begin(), index.end());
  if (n < 2) return out;
  const bool floats = std::none_of(problem.poses.begin(), problem.poses.end(), [](const auto& p) { return p.fixed; });

  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(6 * n, 6 * n);
  std::vector<PointBlocks> blocks(problem.points.size());
  for (std::size_t i = 0; i < problem.observations.size(); ++i) {
    const BundleProblem::Observation& o = problem.observations[i];
    const BundleProblem::Pose& pose = problem.poses[static_cast<std::size_t>(o.pose)];
    const int at = index[static_cast<std::size_t>(o.pose)];
    if (!use[i] || (at < 0 && !pose.fixed)) continue;
    const Eigen::Vector3d in_cam = pose.cam_from_world * problem.points[static_cast<std::size_t>(o.point)];
    if (in_cam.z() <= 0) continue;
    const CameraModel& camera = problem.cameras[static_cast<std::size_t>(pose.camera)];
    const Eigen::Matrix<double, 2, 3> by_cam =
        camera.raw_by_undistorted(o.undistorted_px) * camera.project_jacobian(in_cam) / o.sigma_px;
    const Eigen::Matrix<double, 2, 3> by_point = by_cam * pose.cam_from_world.rotation.toRotationMatrix();
    PointBlocks& b = blocks[static_cast<std::size_t>(o.point)];
    b.block += by_point.transpose() * by_point;
    if (at < 0) continue;
    Eigen::Matrix<double, 2, 6> by_pose;
    by_pose << -by_cam * skew(in_cam), by_cam;
    information.block<6, 6>(6 * at, 6 * at) += by_pose.transpose() * by_pose;
    b.coupling.emplace_back(at, by_pose.transpose() * by_point);
  }
  const std::vector<Eigen::Matrix3d> own_inverse = eliminate(&blocks, &information);
  const Eigen::MatrixXd covariance = pose_covariance(std::move(information), problem, index, floats);
  if (!covariance.allFinite()) return out;
  for (std::size_t p = 0; p < blocks.size(); ++p) out[p] = share_of(blocks[p], own_inverse[p], covariance);
  return out;
}

}  // namespace coslam
