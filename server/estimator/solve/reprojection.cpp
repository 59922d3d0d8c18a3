// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/solve/reprojection.h"

#include <Eigen/Geometry>

namespace coslam {
namespace {

constexpr double kNearest = 1e-4;  // else it counts as behind the camera
const Eigen::Vector2d kBehind(1e3, 1e3);

Reprojection behind() { return {kBehind, Eigen::Matrix<double, 2, 6>::Zero(), Eigen::Matrix<double, 2, 3>::Zero()}; }

// by_x: of the residual, by the point x in the camera frame that the rotation leads to.
Reprojection by_pose_and_point(const Eigen::Vector2d& residual, const Eigen::Matrix<double, 2, 3>& by_x,
                               const Eigen::Vector3d& x, const Eigen::Matrix3d& rotation) {
  Reprojection out;
  out.residual = residual;
  out.by_pose.leftCols<3>() = -by_x * skew(x);
  out.by_pose.rightCols<3>() = by_x;
  out.by_point = by_x * rotation;
  return out;
}

}  // namespace

Eigen::Vector2d reprojection_residual(const CameraModel& camera, const Eigen::Matrix2d& whiten,
                                      const Eigen::Vector2d& undistorted_px, const Eigen::Vector3d& in_cam) {
  if (in_cam.z() < kNearest) return kBehind;
  return whiten * (camera.project(in_cam) - undistorted_px);
}

Reprojection reprojection(const CameraModel& camera, const Eigen::Matrix2d& whiten,
                          const Eigen::Vector2d& undistorted_px, const Eigen::Matrix3d& rotation,
                          const Eigen::Vector3d& translation, const Eigen::Vector3d& point) {
  const Eigen::Vector3d x = rotation * point + translation;
  if (x.z() < kNearest) return behind();
  return by_pose_and_point(reprojection_residual(camera, whiten, undistorted_px, x),
                           whiten * camera.project_jacobian(x), x, rotation);
}

Eigen::Vector2d lens_reprojection_residual(const CorrectedLens& lens, const Eigen::Vector2d& raw_px, double sigma_px,
                                           const Eigen::Vector3d& in_cam) {
  if (in_cam.z() < kNearest) return kBehind;
  return (lens.raw_from_normalized(in_cam.hnormalized()) - raw_px) / sigma_px;
}

Reprojection lens_reprojection(const CorrectedLens& lens, const Eigen::Vector2d& raw_px, double sigma_px,
                               const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation,
                               const Eigen::Vector3d& point,
                               Eigen::Matrix<double, 2, LensCorrection::kTerms>* by_lens) {
  const Eigen::Vector3d x = rotation * point + translation;
  by_lens->setZero();
  if (x.z() < kNearest) return behind();
  const Eigen::Vector2d n = x.hnormalized();
  LensCorrection::Jacobians j;
  const Eigen::Vector2d residual = (lens.raw_from_normalized(n, &j) - raw_px) / sigma_px;
  Eigen::Matrix<double, 2, 3> n_by_x;
  n_by_x << 1, 0, -n.x(), 0, 1, -n.y();
  *by_lens = j.by_values / sigma_px;
  return by_pose_and_point(residual, j.by_normalized * n_by_x / (x.z() * sigma_px), x, rotation);
}

Tie tie(const Rigid3& second_from_first, const Rigid3& first, const Rigid3& second) {
  constexpr double kTurnWeight = 1 / 1e-3, kShift = 1e-3;
  const double shift_weight = 1 / (kShift * second_from_first.translation.norm());
  const Rigid3 is = second * first.inverse();
  Eigen::Quaterniond off = is.rotation * second_from_first.rotation.conjugate();
  if (off.w() < 0) off.coeffs() = -off.coeffs();
  Tie out;
  out.residual << 2 * kTurnWeight * off.vec(), shift_weight * (is.translation - second_from_first.translation);
  // exp(w) is * ... : 2 vec(off) changes by (off.w I - [off.vec]) w.
  const Eigen::Matrix3d by_turn = kTurnWeight * (off.w() * Eigen::Matrix3d::Identity() - skew(off.vec()));
  const Eigen::Matrix3d r = is.rotation.toRotationMatrix();
  out.by_first << -by_turn * r, Eigen::Matrix3d::Zero(), Eigen::Matrix3d::Zero(), -shift_weight * r;
  out.by_second << by_turn, Eigen::Matrix3d::Zero(), -shift_weight * skew(is.translation),
      shift_weight * Eigen::Matrix3d::Identity();
  return out;
}

}  // namespace coslam
