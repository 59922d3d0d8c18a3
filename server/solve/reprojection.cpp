// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/solve/reprojection.h"

#include <ceres/sized_cost_function.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "server/solve/lens.h"

namespace coslam {
namespace {

constexpr double kNearest = 1e-4;  // else it counts as behind the camera
const Eigen::Vector2d kBehind(1e3, 1e3);

class PoseManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return 6; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    const Rigid3 pose(Eigen::Map<const Eigen::Quaterniond>(x), Eigen::Map<const Eigen::Vector3d>(x + 4));
    const Rigid3 moved = retract(pose, Eigen::Map<const Vector6d>(delta));
    Eigen::Map<Eigen::Quaterniond> rotation(x_plus_delta);
    Eigen::Map<Eigen::Vector3d> translation(x_plus_delta + 4);
    rotation = moved.rotation;
    translation = moved.translation;
    return true;
  }
  // The cost below writes its Jacobian in local coordinates into the first six columns, so this is a plain selection.
  bool PlusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>> j(jacobian);
    j.setZero();
    j.topRows<6>().setIdentity();
    return true;
  }
  bool Minus(const double* y, const double* x, double* y_minus_x) const override {
    const Rigid3 from(Eigen::Map<const Eigen::Quaterniond>(x), Eigen::Map<const Eigen::Vector3d>(x + 4));
    const Rigid3 to(Eigen::Map<const Eigen::Quaterniond>(y), Eigen::Map<const Eigen::Vector3d>(y + 4));
    Eigen::Map<Vector6d> difference(y_minus_x);
    difference = local(from, to);
    return true;
  }
  bool MinusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>> j(jacobian);
    j.setZero();
    j.leftCols<6>().setIdentity();
    return true;
  }
};

// by_x: of the weighted residual, by the point x in the camera frame that the rotation r leads to.
void write_pose_and_point(const Eigen::Matrix<double, 2, 3>& by_x, const Eigen::Vector3d& x, const Eigen::Matrix3d& r,
                          double** jacobians) {
  if (jacobians[0] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 2, 7, Eigen::RowMajor>> j(jacobians[0]);
    j.leftCols<3>() = -by_x * skew(x);
    j.middleCols<3>(3) = by_x;
    j.col(6).setZero();
  }
  if (jacobians[1] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 2, 3, Eigen::RowMajor>> j(jacobians[1]);
    j = by_x * r;
  }
}

class LensReprojectionCost final : public ceres::SizedCostFunction<2, 7, 3, 5> {
 public:
  LensReprojectionCost(const CameraModel& camera, const Eigen::Vector2d& undistorted_px, double sigma_px)
      : camera_(camera), px_(undistorted_px), weight_(camera.raw_by_undistorted(undistorted_px) / sigma_px) {}

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const Eigen::Map<const Eigen::Quaterniond> q(parameters[0]);
    const Eigen::Map<const Eigen::Vector3d> t(parameters[0] + 4), point(parameters[1]);
    LensChange lens;
    std::copy_n(parameters[2], lens.values.size(), lens.values.begin());
    const Eigen::Matrix3d r = q.toRotationMatrix();
    const Eigen::Vector3d x = r * point + t;
    Eigen::Map<Eigen::Vector2d> residual(residuals);
    if (x.z() < kNearest) {
      residual = kBehind;
      constexpr std::array<int, 3> kSizes{14, 6, 10};
      for (std::size_t i = 0; jacobians != nullptr && i < kSizes.size(); ++i) {
        if (jacobians[i] != nullptr) std::fill_n(jacobians[i], kSizes[i], 0.0);
      }
      return true;
    }
    residual = weight_ * (lens.project(camera_, x) - px_);
    if (jacobians == nullptr) return true;
    const Eigen::Vector2d n = x.hnormalized(), f(camera_.fx, camera_.fy);
    const double r2 = n.squaredNorm(), k1 = lens.values[3], k2 = lens.values[4], scale = std::exp(lens.log_focal());
    const double g = 1 + r2 * (k1 + r2 * k2);
    const Eigen::Matrix2d by_n = scale * weight_ * f.asDiagonal() *
                                 (g * Eigen::Matrix2d::Identity() + 2 * (k1 + 2 * k2 * r2) * n * n.transpose());
    Eigen::Matrix<double, 2, 3> n_by_x;
    n_by_x << 1, 0, -n.x(), 0, 1, -n.y();
    const Eigen::Matrix<double, 2, 3> p = by_n * n_by_x / x.z();
    write_pose_and_point(p, x, r, jacobians);
    if (jacobians[2] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 2, 5, Eigen::RowMajor>> j(jacobians[2]);
      const Eigen::Vector2d fn = scale * weight_ * f.cwiseProduct(n);
      j << g * fn, weight_, r2 * fn, r2 * r2 * fn;
    }
    return true;
  }

 private:
  const CameraModel& camera_;
  Eigen::Vector2d px_;
  Eigen::Matrix2d weight_;  // raw px by undistorted px, over sigma
};

class TieCost final : public ceres::SizedCostFunction<6, 7, 7> {
 public:
  explicit TieCost(const Rigid3& second_from_first) : tie_(second_from_first) {}

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const Tie is = tie(tie_, pose_of(parameters[0]), pose_of(parameters[1]));
    Eigen::Map<Vector6d>{residuals} = is.residual;
    for (int i = 0; jacobians != nullptr && i < 2; ++i) {
      if (jacobians[i] == nullptr) continue;
      Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>> j(jacobians[i]);
      j.leftCols<6>() = i == 0 ? is.by_first : is.by_second;
      j.col(6).setZero();
    }
    return true;
  }

 private:
  static Rigid3 pose_of(const double* block) {
    return {Eigen::Map<const Eigen::Quaterniond>(block).normalized(), Eigen::Map<const Eigen::Vector3d>(block + 4)};
  }

  Rigid3 tie_;
};

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
  Reprojection out;
  out.residual = reprojection_residual(camera, whiten, undistorted_px, x);
  if (x.z() < kNearest) {
    out.by_pose.setZero();
    out.by_point.setZero();
    return out;
  }
  const Eigen::Matrix<double, 2, 3> by_x = whiten * camera.project_jacobian(x);
  out.by_pose.leftCols<3>() = -by_x * skew(x);
  out.by_pose.rightCols<3>() = by_x;
  out.by_point = by_x * rotation;
  return out;
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

std::unique_ptr<ceres::Manifold> make_pose_manifold() { return std::make_unique<PoseManifold>(); }

std::unique_ptr<ceres::CostFunction> make_lens_reprojection_cost(const CameraModel& camera,
                                                                 const Eigen::Vector2d& undistorted_px,
                                                                 double sigma_px) {
  return std::make_unique<LensReprojectionCost>(camera, undistorted_px, sigma_px);
}

std::unique_ptr<ceres::CostFunction> make_tie_cost(const Rigid3& second_from_first) {
  return std::make_unique<TieCost>(second_from_first);
}

}  // namespace coslam
