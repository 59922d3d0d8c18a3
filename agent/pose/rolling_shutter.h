// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <unordered_map>
#include <vector>

#include "common/base/ids.h"
#include "common/base/time.h"
#include "common/geometry/camera_model.h"

namespace coslam {

struct SeenPlace {
  TrackId track;
  double raw_row_px = 0;
  Eigen::Vector2d undistorted_px = Eigen::Vector2d::Zero();
};

// Rows of an image that are read one after the other are of different instants. A camera that turns by w in a second
// sees at row r what at the instant of the middle row lies at
//   exp(-w t(r)) n,   t(r) = (r / height - 1/2) readout_s,
// a direction n in the camera frame. Turns of a tenth of a degree between the first row and the last are pixels; what
// the camera moves meanwhile is far less, and left. Thread-compatible.
class RollingShutter {
 public:
  // readout_s: from the first row to the last; 0 leaves all as it is.
  RollingShutter(const CameraModel& camera, double readout_s) : camera_(camera), readout_s_(readout_s) {}

  // Brings the places of the next image to the instant of its middle row. The turn is the one that the directions of
  // tracks made since the image before.
  void correct(TimeNs capture_ns, std::vector<SeenPlace>* places);

 private:
  CameraModel camera_;
  double readout_s_;
  TimeNs last_ns_ = 0;
  std::unordered_map<TrackId, Eigen::Vector3d> last_;  // directions in the image before
};

}  // namespace coslam
