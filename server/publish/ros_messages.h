// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/ros/messages.h"
#include "server/publish/names.h"
#include "server/publish/snapshot.h"

// Snapshots as messages of ROS 2. Frames: see frame_of() and camera_frame().
namespace coslam {

ros::TFMessage tf_message(const PublicPoses& poses, RosNames& names);
// A covariance that nobody knows is very large.
ros::Odometry odometry(const PublicPose& pose, MapId main, RosNames& names);
ros::Path path(const PublicPath& path, const PublicInstant& instant);
// Points of all maps; field `map` says whose frame the coordinates are in.
ros::PointCloud2 static_cloud(const PublicCloud& cloud);
// Of the main map.
ros::PointCloud2 moving_cloud(const PublicMoving& moving);
ros::MarkerArray object_markers(const PublicMoving& moving);  // of all maps
ros::Detection3DArray object_detections(const PublicMoving& moving);

}  // namespace coslam
