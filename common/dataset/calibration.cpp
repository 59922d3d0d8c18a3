// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/dataset/calibration.h"

#include <algorithm>
#include <fstream>

#include "common/base/error.h"
#include "common/base/file_kind.h"
#include "common/base/text.h"
#include "common/dataset/calibration_dialects.h"
#include "common/dataset/file.h"
#include "common/dataset/live_topic.h"
#include "common/dataset/recorded_topic.h"

namespace coslam {
namespace {

bool has_any(const YamlValue& root, std::initializer_list<const char*> keys) {
  return std::any_of(keys.begin(), keys.end(), [&](const char* key) { return root.has(key); });
}

bool is_kalibr(const YamlValue& root) {
  const auto keys = root.keys();
  if (keys.empty()) return false;
  const auto first = root.find(keys.front());
  return first && first->is_map() && keys.front().starts_with("cam") &&
         !has_any(root, {"camera_matrix", "cameraMatrix"});
}

bool is_kitti(const YamlValue& root) {
  return has_any(root, {"P0", "P1", "P2", "P3", "P_rect_00", "P_rect_01", "P_rect_02", "P_rect_03"});
}

calibration::SensorCamera read_yaml(const YamlValue& root, const std::string& camera) {
  const bool several = is_kalibr(root) || is_kitti(root) || has_any(root, {"cameras", "value0"});
  if (!camera.empty() && !several) root.fail("of this form there is one camera in a file: leave out #" + camera);
  if (has_any(root, {"fx", "fy"})) return calibration::read_plain(root);
  if (root.has("sensor_type")) return calibration::read_euroc(root);
  if (has_any(root, {"Camera.fx", "Camera1.fx", "Camera.type", "Camera"})) return calibration::read_orb_slam(root);
  if (root.has("model_type")) return calibration::read_camodocal(root);
  if (root.has("cameras")) return calibration::read_maplab(root, camera);
  if (is_kitti(root)) return calibration::read_kitti(root, camera);
  if (is_kalibr(root)) return calibration::read_kalibr(root, camera);
  if (root.has("distortion_model") && has_any(root, {"camera_matrix", "k", "K"})) return calibration::read_ros(root);
  if (has_any(root, {"camera_matrix", "cameraMatrix", "Camera_Matrix", "K"})) return calibration::read_opencv(root);
  if (root.has("camera_model") && root.has("intrinsics")) return calibration::read_euroc(root);
  if (root.has("value0")) return calibration::read_basalt(root, camera);
  root.fail(
      std::string("not a calibration: none of width/height/fx/fy/cx/cy, OpenCV, ROS camera_info, Kalibr camchain or "
                  "EuRoC sensor.yaml keys") +
      but_it_is(root.file()) + "; " + calibration::kOtherForms);
}

YamlValue load_yaml(const std::filesystem::path& file) {
  try {
    return YamlValue::load(file);
  } catch (const UserError& e) {
    if (!std::filesystem::is_regular_file(file)) throw;
    throw UserError(std::string(e.what()) + "; " + calibration::kOtherForms);
  }
}

// COLMAP's cameras.txt is the one form that is no YAML: lines `ID MODEL ...`.
bool is_colmap(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string line;
  while (std::getline(stream, line)) {
    const auto fields = split_fields(line);
    if (fields.empty() || fields[0].starts_with('#')) continue;
    return fields.size() >= 2 && parse_integer(fields[0]).has_value();
  }
  return false;
}

// The first line of the file that is not empty.
std::string first_line(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string line;
  while (std::getline(stream, line)) {
    if (!trimmed(line).empty()) return std::string(trimmed(line));
  }
  return {};
}

bool is_dso(const std::string& first) {
  auto fields = split_fields(first);
  const bool named = !fields.empty() && !parse_double(fields.front());
  if (named) fields.erase(fields.begin());
  return fields.size() >= 4 && fields.size() <= 9 &&
         std::ranges::all_of(fields, [](std::string_view f) { return parse_double(f).has_value(); });
}

calibration::SensorCamera read_any(const std::filesystem::path& file, const std::string& camera) {
  if (names_recorded_topic(file.string())) return calibration::read_recorded(recorded_topic(file.string()));
  if (recording::is_recording(file)) return calibration::read_recorded({"", file, camera});
  if (file.string().starts_with(kRos2Scheme)) {
    throw UserError(file.string() +
                    " is heard by agents at work alone: report.json of their result has what they heard");
  }
  if (is_colmap(file)) return calibration::read_colmap(file, camera);
  const std::string first = first_line(file);
  if (first.starts_with("# oST") || first == "[image]") return calibration::read_ost(file);
  if (is_dso(first)) return calibration::read_dso(file);
  if (first.starts_with("<?xml")) return calibration::read_opencv_xml(file);
  return read_yaml(load_yaml(file), camera);
}

ReadCalibration checked(const calibration::SensorCamera& camera, const std::string& name) {
  if (const auto problem = problem_of(camera.model)) throw UserError(name + ": " + *problem);
  if (const auto problem = unit_problem_of(camera.model); !problem.empty()) throw UserError(name + ": " + problem);
  ReadCalibration out{camera.model, doubt_of(camera.model, camera.part)};
  if (!out.doubt.text.empty()) out.doubt.text.insert(0, name + ": ");
  return out;
}

}  // namespace

CalibrationFile calibration_file(const std::filesystem::path& name) {
  const std::string text = name.string();
  const std::size_t mark = text.rfind('#');
  const bool topic = names_recorded_topic(text) || text.starts_with(kRos2Scheme);
  if (topic || mark == std::string::npos || std::filesystem::exists(name)) return {name, ""};
  return {text.substr(0, mark), text.substr(mark + 1)};
}

ReadCalibration read_calibration(const std::filesystem::path& name) {
  const auto [file, camera] = calibration_file(name);
  return checked(read_any(file, camera), name.string());
}

ReadCalibration read_calibration(const ros::CameraInfo& info, const std::string& name) {
  return checked(calibration::read_info(info, name), name);
}

CameraModel load_calibration(const std::filesystem::path& name) { return read_calibration(name).camera; }

std::string plain_text(const CameraModel& camera) {
  const double scale = focal_in_files(camera);
  std::string bent;
  for (std::size_t i = 0; i < coefficient_count(camera); ++i) {
    bent += (i == 0 ? "" : ", ") + format_double(camera.coefficients[i]);
  }
  return "width: " + std::to_string(camera.width_px) + "\nheight: " + std::to_string(camera.height_px) +
         "\nfx: " + format_double(camera.fx * scale) + "\nfy: " + format_double(camera.fy * scale) +
         "\ncx: " + format_double(camera.cx) + "\ncy: " + format_double(camera.cy) +
         "\ndistortion_model: " + std::string(lens_traits(camera.distortion).name()) + "\ndistortion: [" + bent + "]\n";
}

void save_calibration(const std::filesystem::path& file, const CameraModel& camera) {
  std::ofstream stream = create_file(file);
  stream << plain_text(camera);
  close_file(stream, file);
}

}  // namespace coslam
