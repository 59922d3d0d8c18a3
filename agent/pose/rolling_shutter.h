// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "agent/pose/readout.h"
#include "common/base/ids.h"
#include "common/base/time.h"
#include "common/geometry/camera_model.h"

namespace coslam {

// Rows of an image that are read one after the other are of different instants. A camera that turns by w in a second
// sees at row r what at the instant of the middle row lies at
//   exp(-w t(r)) n,   t(r) = (r / height - 1/2) readout_s,
// a direction n in the camera frame. Turns of a tenth of a degree between the first row and the last are pixels; what
// the camera moves meanwhile is far less, and left. Thread-compatible.
class RollingShutter {
 public:
  // readout_s: from the first row to the last; 0 leaves all as it is; negative: found out.
  RollingShutter(const CameraModel& camera, double readout_s)
      : camera_(camera), configured_s_(readout_s), estimate_(camera) {}

  // Brings the places of the next image to the instant of its middle row. The turn is the one that the directions of
  // tracks made since the image before.
  void correct(TimeNs capture_ns, std::vector<SeenPlace>* places);
  double readout_s() const { return configured_s_ < 0 ? estimate_.readout_s() : configured_s_; }
  // Estimated readout time; 0 when it is configured.
  double found_s() const { return configured_s_ < 0 ? estimate_.readout_s() : 0; }

 private:
  CameraModel camera_;
  double configured_s_;
  std::optional<TimeNs> last_ns_;
  ReadoutEstimate estimate_;
};

}  // namespace coslam
