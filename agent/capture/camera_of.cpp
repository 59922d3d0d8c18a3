// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/camera_of.h"

#include <algorithm>

#include "common/base/error.h"
#include "common/dataset/calibration.h"

namespace coslam {

CameraModel guessed_camera(int width_px, int height_px) {
  // 28 mm, as 35 mm film has it, of what a phone films; most cameras of robots lie between 0.6 and 1 as well.
  constexpr double kFocalByWidth = 0.8;
  CameraModel camera{.width_px = width_px, .height_px = height_px};
  camera.fx = camera.fy = kFocalByWidth * std::max(width_px, height_px);
  camera.cx = 0.5 * (width_px - 1);
  camera.cy = 0.5 * (height_px - 1);
  camera.distortion = DistortionModel::kUnknown;
  return camera;
}

CameraModel camera_of(const std::string& source, const std::string& calibration, const SourceOptions& options) {
  if (!calibration.empty()) return load_calibration(calibration);
  SourceOptions any_size = options;
  any_size.width_px = any_size.height_px = 0;
  const auto first = open_source(source, any_size)->next();
  if (!first) throw UserError(source + ": no image can be read");
  return guessed_camera(first->grey.cols, first->grey.rows);
}

CameraSource open_camera(const std::string& source, const std::string& calibration, SourceOptions options) {
  CameraSource out{camera_of(source, calibration, options), nullptr};
  options.width_px = out.camera.width_px;
  options.height_px = out.camera.height_px;
  options.calibration = calibration;
  out.images = open_source(source, options);
  return out;
}

}  // namespace coslam
