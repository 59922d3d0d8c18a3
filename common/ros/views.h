// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "common/base/ids.h"
#include "common/ros/geometry_messages.h"
#include "common/ros/sensor_messages.h"
#include "common/ros/view_messages.h"

// Content of the map's public topics as plain values, equal live, in files and over DDS. Coordinates are in the frame
// of the header.
namespace coslam::ros {

struct StaticPoint {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();
  float sigma = 0;  // square root of the trace of its covariance
  PointId id;
  MapId map;
  bool on_trial = false;
  std::uint16_t views = 0;
};

struct MovingPoint {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();
  float sigma = 0;
  PointId id;
  ObjectId object;  // 0: in none
};

struct MovingObject {
  ObjectId id;
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_per_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d extent = Eigen::Vector3d::Zero();  // sides of its box along the axes of the frame
};

// Fields x y z sigma (float32), id map (uint32), state (uint8: 0 static, 1 on trial), views (uint16).
PointCloud2 static_cloud(const Header& header, std::span<const StaticPoint> points);
// Fields x y z sigma (float32), id object (uint32).
PointCloud2 moving_cloud(const Header& header, std::span<const MovingPoint> points);
// A box and an arrow, where it is in a second, for each object; their id is the object's. They last half a second.
MarkerArray object_markers(const Header& header, std::span<const MovingObject> objects);
Detection3DArray object_detections(const Header& header, std::span<const MovingObject> objects);

}  // namespace coslam::ros
