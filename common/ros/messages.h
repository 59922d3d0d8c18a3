// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tuple>

#include "common/ros/geometry_messages.h"
#include "common/ros/px4_messages.h"
#include "common/ros/sensor_messages.h"
#include "common/ros/std_messages.h"
#include "common/ros/view_messages.h"

namespace coslam::ros {

// Messages that are topics; the others are parts of them.
using Messages =
    std::tuple<String, PoseStamped, PoseArray, PoseWithCovarianceStamped, TransformStamped, TFMessage, Odometry, Path,
               PointCloud2, Image, CompressedImage, CameraInfo, Marker, MarkerArray, Detection3DArray, VehicleOdometry>;

}  // namespace coslam::ros
