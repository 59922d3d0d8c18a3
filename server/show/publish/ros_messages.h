// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/ros/messages.h"
#include "server/show/publish/names.h"
#include "server/show/publish/snapshot.h"

// Snapshots as messages of ROS 2. Frames: see frame_of() and odom_frame(). An agent's pose is that of its base_link.
namespace coslam {

// A map, the odom frame, base_link and the camera of each agent, one in the other.
ros::TFMessage tf_message(const PublicPoses& poses, RosNames& names);
// A covariance that nobody knows is very large.
ros::PoseWithCovarianceStamped pose_in_map(const PublicPose& pose, MapId main);
// Odometry with the covariance of the pose in the map: the drift of the odom frame is not in it.
ros::Odometry odometry(const PublicPose& pose, RosNames& names);
ros::Path path(const PublicPath& path, const PublicInstant& instant);
ros::PoseArray key_frames(const PublicPath& path, const PublicInstant& instant);
// Points of all maps; field `map` says whose frame the coordinates are in.
ros::PointCloud2 static_cloud(const PublicCloud& cloud);
// Moving points of the main map.
ros::PointCloud2 moving_cloud(const PublicMoving& moving);
ros::MarkerArray object_markers(const PublicMoving& moving);  // includes all maps
ros::Detection3DArray object_detections(const PublicMoving& moving);

}  // namespace coslam
