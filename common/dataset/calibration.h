// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "common/geometry/camera_model.h"

namespace coslam {

// Reads a camera from any of the dialects of docs/configuration.md, told apart by their keys: plain form, OpenCV YAML,
// ROS camera_info, Kalibr camchain (first camera unless `camera` names another, e.g. "cam1"), EuRoC sensor.yaml, COLMAP
// cameras.txt; or a CameraInfo in a recording of ROS 2, named mcap:FILE#TOPIC. Throws UserError with file (and line)
// and what is wrong.
CameraModel load_calibration(const std::filesystem::path& file, const std::string& camera = "");

// Writes the plain form.
void save_calibration(const std::filesystem::path& file, const CameraModel& camera);

}  // namespace coslam
