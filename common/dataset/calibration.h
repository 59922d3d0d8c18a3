// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "common/dataset/calibration_doubt.h"
#include "common/geometry/camera_model.h"

namespace coslam {

namespace ros {
struct CameraInfo;
}

// Reads a camera from any of the dialects of docs/inputs.md, told apart by their keys: plain form, OpenCV YAML,
// ROS camera_info, Kalibr camchain, EuRoC sensor.yaml, COLMAP cameras.txt, ORB-SLAM, stella_vslam, camodocal, maplab,
// DSO; or the first CameraInfo that is calibrated of a topic in a recording, named bag:PATH#TOPIC. Of a file with
// several cameras one has to be named: FILE#CAMERA. Throws UserError with file (and line) and what is wrong.
CameraModel load_calibration(const std::filesystem::path& name);

// Camera from a calibration, with the doubts about it.
struct ReadCalibration {
  CameraModel camera;
  CalibrationDoubt doubt;
};
ReadCalibration read_calibration(const std::filesystem::path& name);

// A camera as a node says it; `name` is what the user called it. Throws UserError.
ReadCalibration read_calibration(const ros::CameraInfo& info, const std::string& name);

// FILE#CAMERA in its parts; camera is empty where none is named.
struct CalibrationFile {
  std::filesystem::path file;
  std::string camera;
};
CalibrationFile calibration_file(const std::filesystem::path& name);

// The plain form.
std::string plain_text(const CameraModel& camera);
void save_calibration(const std::filesystem::path& file, const CameraModel& camera);

}  // namespace coslam
