// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/base/ids.h"
#include "common/base/time.h"

namespace coslam {

struct MovingPointState {
  PointId point;
  ObjectId object;                                                             // 0 = in none
  Eigen::Vector3f position = Eigen::Vector3f::Zero();                          // map frame, metres when scale_known
  Eigen::Matrix<float, 6, 1> covariance = Eigen::Matrix<float, 6, 1>::Zero();  // xx xy xz yy yz zz
  std::uint8_t cameras = 0;  // number of cameras that saw it at this instant
};

struct MovingObjectState {
  ObjectId object;
  Eigen::Vector3f centroid = Eigen::Vector3f::Zero();
  Eigen::Vector3f velocity_per_s = Eigen::Vector3f::Zero();
  Eigen::Vector3f extent = Eigen::Vector3f::Zero();  // sides of its box along the axes of the map
  std::uint16_t points = 0;
};

// Moving points and objects of one map at the instant of one frame set; can be read without other messages.
struct MovingState {
  RunId server_run;
  MapId map;
  MapEpoch epoch;
  TimeNs t_ns = 0;  // capture time
  bool scale_known = false;
  std::uint32_t left_out = 0;              // points and objects there was no room for
  std::vector<MovingObjectState> objects;  // sorted by number of points, most first
  std::vector<MovingPointState> points;    // the most certain first
};

// Limits that keep the message within one datagram: a larger one would be sent in fragments, and losing one fragment
// loses all.
constexpr std::size_t kMostMovingObjects = 12;
constexpr std::size_t most_moving_points(std::size_t objects) { return 23 - objects; }

}  // namespace coslam
