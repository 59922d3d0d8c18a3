// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/base/ids.h"

namespace coslam {

// Motion of a body: the mean of its points but for stray ones, their median velocity, and the sides of a box with the
// axes of the map around that centre.
struct BodyMotion {
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  Eigen::Vector3d extent = Eigen::Vector3d::Zero();
};

struct MovingObject {
  ObjectId id;
  MapId map;
  BodyMotion motion;
  std::vector<PointId> members;  // sorted
};

struct ObjectsReport {
  int points = 0;   // moving points that could be in an object
  int objects = 0;  // present objects
  int started = 0;  // objects with a new id
  std::vector<MovingObject> list;

  void count(auto&& add) const {
    add("objects_started", started);
    add("object_sets", objects);
  }
};

}  // namespace coslam
