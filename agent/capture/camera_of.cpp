// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/camera_of.h"

#include <algorithm>
#include <cmath>

#include "agent/capture/noted_focal.h"
#include "agent/capture/ros2_topic.h"
#include "agent/capture/two_views.h"
#include "common/base/error.h"
#include "common/dataset/calibration.h"
#include "common/dataset/live_topic.h"
#include "common/dataset/sequence.h"

namespace coslam {

CameraModel guessed_camera(int width_px, int height_px, std::optional<double> noted_focal_px) {
  // 28 mm, as 35 mm film has it, of what a phone films; most cameras of robots lie between 0.6 and 1 as well.
  constexpr double kFocalByWidth = 0.8;
  CameraModel camera{.width_px = width_px, .height_px = height_px};
  camera.fx = camera.fy = noted_focal_px.value_or(kFocalByWidth * std::max(width_px, height_px));
  camera.cx = 0.5 * (width_px - 1);
  camera.cy = 0.5 * (height_px - 1);
  camera.distortion = DistortionModel::kUnknown;
  return camera;
}

namespace {

// With the size of its first image, which is to be that of one camera: who gives a calibration says so.
FoundCamera guessed_for(const std::string& source, const SourceOptions& options) {
  SourceOptions any_size = options;
  any_size.width_px = any_size.height_px = 0;
  const auto first = next_readable(*open_source(source, any_size));
  if (!first) throw UserError(shown_source(source) + ": no image can be read");
  const int width_px = first->grey.cols, height_px = first->grey.rows;
  if (shows_two_views(first->grey)) {
    throw UserError(shown_source(source) + ": shows the pictures of two cameras side by side: " +
                    how_to_split(width_px) + "; a calibration says that it is one camera's");
  }
  const auto noted_px = noted_focal_px(first_file(source, options.rate_hz), width_px, height_px);
  FoundCamera out{guessed_camera(width_px, height_px, noted_px), {}};
  out.guess = "no calibration is given: the lens is guessed, with a focal length of " +
              std::to_string(std::lround(out.camera.fx)) + " px as " +
              (noted_px ? "its files note it" : "cameras of phones and robots have it") +
              ", and found out from the images";
  return out;
}

// A calibration that no lens can have says at most how large the images are, and perhaps the focal length.
FoundCamera guessed_lens(const ReadCalibration& read) {
  FoundCamera out{guessed_camera(read.camera.width_px, read.camera.height_px, read.doubt.focal_px), {}};
  out.guess = read.doubt.text + " It is left aside, and the lens found out from the images, from a focal length of " +
              std::to_string(std::lround(out.camera.fx)) + " px on";
  return out;
}

}  // namespace

FoundCamera camera_of(const std::string& source, const std::string& calibration, const SourceOptions& options) {
  if (calibration.empty()) return guessed_for(source, options);
  const ReadCalibration read =
      calibration.starts_with(kRos2Scheme) ? heard_camera(calibration) : read_calibration(calibration);
  return read.doubt.hopeless ? guessed_lens(read) : FoundCamera{read.camera, read.doubt.text};
}

CameraSource open_camera(const std::string& source, const std::string& calibration, SourceOptions options) {
  CameraSource out{camera_of(source, calibration, options), nullptr};
  options.width_px = out.found.camera.width_px;
  options.height_px = out.found.camera.height_px;
  options.calibration = calibration;
  out.images = open_source(source, options);
  return out;
}

}  // namespace coslam
