// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/geometry/camera_model.h"

namespace coslam {

// Nearest camera of another distortion model, over the image: least squares of where rays are seen, in raw pixels.
struct NearestCamera {
  CameraModel camera;
  double miss_px = 0;  // the largest, in the image
};
// coefficients: how many of the model's are free; the rest are 0.
NearestCamera nearest_camera(const CameraModel& original, DistortionModel model, int coefficients);

// A calibration as another program reads it.
struct WrittenCalibration {
  std::string text;
  CameraModel camera;  // camera that the text describes
  double miss_px = 0;  // 0: exactly the one that was asked for
};
// plain, opencv, ros, kalibr, colmap, orbslam. Throws UserError for any other.
WrittenCalibration written_calibration(const CameraModel& camera, const std::string& dialect);
std::vector<std::string> calibration_dialects();

}  // namespace coslam
