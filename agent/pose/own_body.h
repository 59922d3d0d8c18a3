// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "agent/track/feature_tracker.h"
#include "common/base/time.h"
#include "common/geometry/camera_model.h"

namespace coslam {

// Finds the parts of the picture that move with the camera: its vehicle's body, a gripper, a mount, text that was
// written into the picture. They stay in place whenever the rest of the picture turns, while distant things turn with
// it. A part counts once the picture turned for seconds, about more than one axis or both ways, and only if it always
// did the same: behind traffic the same road now stands still and now moves. Pure.
class OwnBody {
 public:
  explicit OwnBody(const CameraModel& camera);

  // The live tracks of each image. True when more was found.
  bool step(TimeNs capture_ns, const std::vector<Track>& live);
  ImageParts found() const;
  // Share of the picture.
  double share() const;

 private:
  struct Cell {
    int stood = 0, turned = 0;  // looks
    bool found = false;
  };
  // A track that moved in the image.
  struct Pair {
    Eigen::Vector2d before_px, now_px;  // raw
    Eigen::Vector3d before, now;        // directions
  };
  // Motion of the tracks since the image before.
  struct Steps {
    std::vector<Pair> moved;
    std::vector<std::pair<Eigen::Vector2f, Eigen::Vector3d>> stood;  // raw pixel, and its direction
  };
  Steps steps_of(const std::vector<Track>& live) const;
  void look(const std::vector<Track>& live);
  bool decide(TimeNs now_ns);
  Cell& cell_at(const Eigen::Vector2f& raw_px);

  const CameraModel camera_;
  const double px_;  // size of a pixel of an image of 640 pixels across
  std::vector<Cell> cells_;
  std::vector<Track> before_;
  std::optional<TimeNs> before_ns_;
  int looks_ = 0;  // at pictures that turned
  TimeNs first_look_ns_ = 0;
  Eigen::Vector3d axes_ = Eigen::Vector3d::Zero();  // sum of the unit axes of their turns
};

}  // namespace coslam
