// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/config/yaml_value.h"
#include "common/dataset/lens_fit.h"
#include "common/dataset/recorded_topic.h"
#include "common/geometry/camera_model.h"
#include "common/geometry/lens_forms.h"
#include "common/ros/sensor_messages.h"

// One reader per calibration dialect; each throws UserError with the place. Internal to calibration.cpp.
namespace coslam::calibration {

// part: its image is a region of interest of the sensor's.
struct SensorCamera {
  // NOLINTNEXTLINE(google-explicit-constructor): any camera is that of a sensor, and most of a whole one
  SensorCamera(const CameraModel& camera, bool is_part = false) : model(camera), part(is_part) {}
  CameraModel model;
  bool part;
};

CameraModel read_plain(const YamlValue& root);
CameraModel read_opencv(const YamlValue& root);    // camera_matrix as !!opencv-matrix
CameraModel read_orb_slam(const YamlValue& root);  // Camera.fx or Camera1.fx; also of stella_vslam, flat or nested
SensorCamera read_ros(const YamlValue& root);      // camera_info, from a file or from a topic
CameraModel read_kalibr(const YamlValue& root, const std::string& camera);
CameraModel read_euroc(const YamlValue& root);
CameraModel read_camodocal(const YamlValue& root);
CameraModel read_maplab(const YamlValue& root, const std::string& camera_name);
CameraModel read_basalt(const YamlValue& root, const std::string& camera);
CameraModel read_kitti(const YamlValue& root, const std::string& camera);  // calib_cam_to_cam.txt, calib.txt
CameraModel read_ost(const std::filesystem::path& file);                   // format of ROS's camera_calibration
CameraModel read_opencv_xml(const std::filesystem::path& file);
CameraModel read_dso(const std::filesystem::path& file);
CameraModel read_colmap(const std::filesystem::path& cameras_txt, const std::string& camera);

SensorCamera read_recorded(const RecordedTopic& topic);  // first calibrated CameraInfo of the topic
SensorCamera read_info(const ros::CameraInfo& info, const std::string& name);

// A side of the image; what is far out of range stays so.
int pixels(const YamlValue& value);

// Sentence for a file with several cameras of which none was named.
std::string several_cameras(const std::string& names);

// Sets model and coefficients from a model name of any dialect. Refuses unknown models and counts.
void set_distortion(CameraModel& camera, const YamlValue& place, const std::string& model,
                    const std::vector<double>& coefficients);

// Gives a camera with the focal lengths of its file the lens of that file.
void set_lens(CameraModel& camera, DistortionModel model, const std::vector<double>& coefficients);

// The nearest lens of ours to one of that kind, which is said; of a camera that has its projection.
void set_fit(CameraModel& camera, const YamlValue& place, const char* model, const RadiusOfAngle& radius);
void set_eucm(CameraModel& camera, const YamlValue& place, double alpha, double beta);

// Advice in errors about a file of unknown form.
inline constexpr const char* kOtherForms =
    "write the numbers of another form as width, height, fx, fy, cx, cy, distortion_model and distortion";

// "a, b and c" of names, each once, for errors.
std::string listed(const std::vector<std::string_view>& names);

}  // namespace coslam::calibration
