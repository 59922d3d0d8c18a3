// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/pose/rolling_shutter.h"

#include "common/geometry/rigid3.h"

namespace coslam {
void RollingShutter::correct(TimeNs capture_ns, std::vector<SeenPlace>* places) {
  if (configured_s_ == 0) return;
  if (!last_ns_ || capture_ns != *last_ns_) estimate_.take(capture_ns, *places);  // an image may be looked at twice
  last_ns_ = capture_ns;
  const auto turn_rad_s = estimate_.turn_rad_s();
  if (!turn_rad_s || readout_s() <= 0) return;
  for (SeenPlace& p : *places) {
    const double late_s = (p.raw_row_px / camera_.height_px - 0.5) * readout_s();
    const Eigen::Vector3d back =
        so3_exp(-late_s * *turn_rad_s) * camera_.normalized_from_pixel(p.undistorted_px).homogeneous();
    if (back.z() > 0) p.undistorted_px = camera_.project(back);
  }
}

}  // namespace coslam
