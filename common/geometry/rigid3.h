// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace coslam {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

Eigen::Matrix3d skew(const Eigen::Vector3d& v);
Eigen::Quaterniond so3_exp(const Eigen::Vector3d& omega_rad);
Eigen::Vector3d so3_log(const Eigen::Quaterniond& q);

// Rigid transform: x_in_b = rotation * x_in_a + translation for a variable named b_from_a, so that names cancel:
// c_from_a = c_from_b * b_from_a. The rotation is a unit quaternion.
struct Rigid3 {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Rigid3() = default;
  Rigid3(const Eigen::Quaterniond& q, const Eigen::Vector3d& t) : rotation(q), translation(t) {}

  Eigen::Vector3d operator*(const Eigen::Vector3d& x) const { return rotation * x + translation; }
  Rigid3 operator*(const Rigid3& o) const {
    return {(rotation * o.rotation).normalized(), rotation * o.translation + translation};
  }
  Rigid3 inverse() const {
    const Eigen::Quaterniond r = rotation.conjugate();
    return {r, -(r * translation)};
  }
  Eigen::Matrix<double, 3, 4> matrix() const;
  // Camera centre in the world, for a cam_from_world transform.
  Eigen::Vector3d center() const { return -(rotation.conjugate() * translation); }
};

// Local perturbation used by every estimator here, tangent order (rotation, translation), applied on the left:
// retract(T, d) = (exp(d_r) R, exp(d_r) t + d_t). It is a first-order se(3) retraction, exact in the rotation.
Rigid3 retract(const Rigid3& pose, const Vector6d& delta);
// Inverse of retract: local(a, b) = d with retract(a, d) = b.
Vector6d local(const Rigid3& from, const Rigid3& to);
// Pose between a (s = 0) and b (s = 1): rotation by slerp, camera translation vector linear.
Rigid3 interpolate(const Rigid3& a, const Rigid3& b, double s);

// Similarity: x_in_b = scale * rotation * x_in_a + translation.
struct Similarity3 {
  double scale = 1.0;
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& x) const { return scale * (rotation * x) + translation; }
  Similarity3 operator*(const Similarity3& o) const {
    return {scale * o.scale, (rotation * o.rotation).normalized(), scale * (rotation * o.translation) + translation};
  }
  Similarity3 inverse() const {
    const Eigen::Quaterniond r = rotation.conjugate();
    return {1.0 / scale, r, -(r * translation) / scale};
  }
};

// The camera's pose after its world was mapped by new_from_old: keeps the camera's image of every point.
Rigid3 transform_world(const Rigid3& cam_from_old, const Similarity3& new_from_old);

}  // namespace coslam
