// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/ros/convert.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>

#include "common/geometry/camera_in_world.h"

namespace coslam::ros {
namespace {

constexpr TimeNs kSecond_ns = 1'000'000'000;

}  // namespace

Time time_of(TimeNs t_ns) {
  TimeNs sec = t_ns / kSecond_ns, rest = t_ns % kSecond_ns;
  if (rest < 0) {
    --sec;
    rest += kSecond_ns;
  }
  using Limits = std::numeric_limits<std::int32_t>;
  sec = std::clamp<TimeNs>(sec, Limits::min(), Limits::max());
  return {static_cast<std::int32_t>(sec), static_cast<std::uint32_t>(rest)};
}

TimeNs ns_of(const Time& time) { return time.sec * kSecond_ns + time.nanosec; }

Header header_of(TimeNs t_ns, std::string frame) { return {time_of(t_ns), std::move(frame)}; }

Point point_of(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }

Vector3 vector_of(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Quaternion quaternion_of(const Eigen::Quaterniond& q) { return {q.x(), q.y(), q.z(), q.w()}; }

Pose pose_of(const Rigid3& frame_from_child) {
  return {point_of(frame_from_child.translation), quaternion_of(frame_from_child.rotation)};
}

Transform transform_of(const Rigid3& frame_from_child) {
  return {vector_of(frame_from_child.translation), quaternion_of(frame_from_child.rotation)};
}

Rigid3 base_from_optical() { return {Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5), Eigen::Vector3d::Zero()}; }

Covariance36 world_covariance(const Rigid3& cam_from_world, const Matrix6d& covariance) {
  Covariance36 rows{};
  Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(rows.data()) =
      camera_covariance_in_world(cam_from_world, covariance);
  return rows;
}

}  // namespace coslam::ros
