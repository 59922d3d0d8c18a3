// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/rigid3.h"

#include <cmath>

namespace coslam {

Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Eigen::Quaterniond so3_exp(const Eigen::Vector3d& omega_rad) {
  const double angle = omega_rad.norm();
  const double half_sinc = angle < 1e-8 ? 0.5 - angle * angle / 48.0 : std::sin(0.5 * angle) / angle;
  return Eigen::Quaterniond(std::cos(0.5 * angle), half_sinc * omega_rad.x(), half_sinc * omega_rad.y(),
                            half_sinc * omega_rad.z())
      .normalized();
}

Eigen::Vector3d so3_log(const Eigen::Quaterniond& q) {
  const double sign = q.w() < 0 ? -1.0 : 1.0;
  const Eigen::Vector3d v = sign * q.vec();
  const double s = v.norm();
  const double w = sign * q.w();
  if (s < 1e-10) return 2.0 * v;
  return 2.0 * std::atan2(s, w) / s * v;
}

Eigen::Matrix<double, 3, 4> Rigid3::matrix() const {
  Eigen::Matrix<double, 3, 4> m;
  m.leftCols<3>() = rotation.toRotationMatrix();
  m.col(3) = translation;
  return m;
}

Rigid3 retract(const Rigid3& pose, const Vector6d& delta) {
  const Eigen::Quaterniond dq = so3_exp(delta.head<3>());
  return {(dq * pose.rotation).normalized(), dq * pose.translation + delta.tail<3>()};
}

Vector6d local(const Rigid3& from, const Rigid3& to) {
  const Eigen::Quaterniond dq = to.rotation * from.rotation.conjugate();
  Vector6d d;
  d.head<3>() = so3_log(dq);
  d.tail<3>() = to.translation - dq * from.translation;
  return d;
}

Rigid3 interpolate(const Rigid3& a, const Rigid3& b, double s) {
  return {a.rotation.slerp(s, b.rotation), (1.0 - s) * a.translation + s * b.translation};
}

Rigid3 transform_world(const Rigid3& cam_from_old, const Similarity3& new_from_old) {
  const Eigen::Quaterniond r = (cam_from_old.rotation * new_from_old.rotation.conjugate()).normalized();
  const Eigen::Vector3d center = new_from_old * cam_from_old.center();
  return {r, -(r * center)};
}

}  // namespace coslam
