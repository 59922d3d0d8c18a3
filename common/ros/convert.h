// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>

#include "common/base/time.h"
#include "common/geometry/rigid3.h"
#include "common/ros/geometry_messages.h"

// Our values as ROS 2 has them. A pose there is where the child is in its frame: the inverse of cam_from_world.
namespace coslam::ros {

Time time_of(TimeNs t_ns);  // held to what 32 bits of seconds can say
TimeNs ns_of(const Time& time);
Header header_of(TimeNs t_ns, std::string frame);

Point point_of(const Eigen::Vector3d& p);
Vector3 vector_of(const Eigen::Vector3d& v);
Quaternion quaternion_of(const Eigen::Quaterniond& q);
Pose pose_of(const Rigid3& frame_from_child);
Transform transform_of(const Rigid3& frame_from_child);

// REP 103: from x right, y down, z ahead, as cameras have it, to x ahead, y left, z up, as bodies have it.
Rigid3 base_from_optical();

// The covariance of world_from_cam, position and fixed-axis rotation in the world, from that of cam_from_world in the
// order of retract().
Covariance36 world_covariance(const Rigid3& cam_from_world, const Matrix6d& covariance);

}  // namespace coslam::ros
