// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <vector>

#include "common/geometry/camera_model.h"
#include "common/geometry/rigid3.h"
#include "common/geometry/triangulation.h"
#include "common/model/track_frame.h"

namespace coslam {

// Points of the agent's live tracks from its own motion alone (the paper's mapping within one camera, without
// adjustment), in the frame of its poses. Nobody else gets them: they hold its pose while it does not hear of the
// server, whose points are better. Thread-compatible.
class OwnMap {
 public:
  explicit OwnMap(const CameraModel& camera) : camera_(camera) {}

  struct Point {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  };

  // A frame with a good pose, and all its tracks, ascending; others are forgotten.
  void observe(const Rigid3& cam_from_world, const std::vector<TrackObservation>& tracks);
  // Position of a track's point; empty while its views do not tell it, or contradict each other.
  std::optional<Point> find(TrackId track) const;

  // The frame of the poses changed.
  void move(const Similarity3& new_from_old);
  void clear() { seen_.clear(); }
  std::size_t size() const { return seen_.size(); }

 private:
  struct Sight {
    Rigid3 cam_from_world;
    Eigen::Vector2d undistorted_px;
  };
  struct Seen {
    std::vector<Sight> sights;                      // few, each from another direction than those before
    Eigen::Vector3d ray = Eigen::Vector3d::Zero();  // the newest sight's ray, in the world
  };

  CameraModel camera_;
  std::map<TrackId, Seen> seen_;
};

}  // namespace coslam
