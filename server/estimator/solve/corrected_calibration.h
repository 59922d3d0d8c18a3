// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/geometry/camera_model.h"
#include "common/geometry/lens_correction.h"

namespace coslam {

// Calibration of the same kind of lens that is nearest to a calibration with its lens correction: exact where the model
// has the terms for it (a pinhole becomes radtan), else with a residual.
struct CorrectedCalibration {
  CameraModel camera;
  double worst_px = 0;  // largest residual in the raw image
};
CorrectedCalibration corrected_calibration(const CameraModel& camera, const LensCorrection& lens);

}  // namespace coslam
