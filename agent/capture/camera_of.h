// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "agent/capture/source.h"
#include "common/geometry/camera_model.h"

namespace coslam {

// A lens of which nothing is known but the size of its images: a pinhole with the focal length that the images note, or
// else that of a usual wide lens, to be found out from the images.
CameraModel guessed_camera(int width_px, int height_px, std::optional<double> noted_focal_px = {});

// The camera of a source: as its calibration says, a file or ros2:/TOPIC, or without one, or with one that no lens can
// have, guessed from what its files note and the size of its first image. Throws UserError.
struct FoundCamera {
  CameraModel camera;
  std::string guess;  // a sentence for the user: what is guessed or doubted; empty: the camera is calibrated
};
FoundCamera camera_of(const std::string& source, const std::string& calibration, const SourceOptions& options);

// Camera with its images, which have to have the size of its calibration.
struct CameraSource {
  FoundCamera found;
  std::unique_ptr<ImageSource> images;
};
CameraSource open_camera(const std::string& source, const std::string& calibration, SourceOptions options);

}  // namespace coslam
