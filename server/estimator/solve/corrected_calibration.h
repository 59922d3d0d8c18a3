// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/geometry/camera_model.h"
#include "common/geometry/lens_correction.h"

namespace coslam {

// The calibration, of the same kind of lens, that is nearest to one with its correction: the same lens where the
// formula has room for what was corrected (a pinhole becomes radtan), else with a miss.
struct CorrectedCalibration {
  CameraModel camera;
  double worst_px = 0;  // largest miss in the raw image
};
CorrectedCalibration corrected_calibration(const CameraModel& camera, const LensCorrection& lens);

}  // namespace coslam
