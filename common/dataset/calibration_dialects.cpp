// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/dataset/calibration_dialects.h"

#include <algorithm>
#include <array>
#include <optional>

#include "common/base/words.h"
#include "common/dataset/lens_fit.h"

namespace coslam::calibration {

int pixels(const YamlValue& value) { return static_cast<int>(std::clamp<std::int64_t>(value.integer(), -1, 1 << 20)); }

namespace {

void set_size(CameraModel& camera, const YamlValue& width_height) {
  const auto items = width_height.items();
  if (items.size() != 2) width_height.fail("[width, height] is expected");
  camera.width_px = pixels(items[0]);
  camera.height_px = pixels(items[1]);
}

void set_intrinsics(CameraModel& camera, const YamlValue& fx_fy_cx_cy) {
  const auto v = fx_fy_cx_cy.numbers();
  if (v.size() != 4) fx_fy_cx_cy.fail("[fx, fy, cx, cy] is expected");
  camera.fx = v[0], camera.fy = v[1], camera.cx = v[2], camera.cy = v[3];
}

// A matrix is a list, or a list of its rows, or a map with one of these under `data`.
std::vector<double> matrix_data(const YamlValue& value) {
  if (value.is_map()) return matrix_data(value.at("data"));
  const auto rows = value.items();
  if (rows.empty() || !rows.front().is_sequence()) return value.numbers();
  std::vector<double> all;
  for (const YamlValue& row : rows) {
    for (const double number : row.numbers()) all.push_back(number);
  }
  return all;
}

void set_camera_matrix(CameraModel& camera, const YamlValue& value) {
  const auto k = matrix_data(value);
  if (k.size() != 9) value.fail("nine elements of a 3x3 matrix are expected");
  if (std::ranges::all_of(k, [](double v) { return v == 0; }))
    value.fail(
        "this camera is not calibrated, its matrix is zero: leave the calibration out, and the lens is found out");
  if (k[3] != 0 || k[6] != 0 || k[7] != 0 || k[8] == 0)
    value.fail("the last row of a camera matrix is 0 0 1: are rows and columns exchanged?");
  if (k[1] != 0) value.fail("a camera with skew is not supported");
  camera.fx = k[0], camera.cx = k[2], camera.fy = k[4], camera.cy = k[5];
}

std::optional<YamlValue> first_of(const YamlValue& root, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    if (auto value = root.find(name)) return value;
  }
  return std::nullopt;
}

YamlValue required(const YamlValue& root, const std::vector<std::string>& names) {
  auto value = first_of(root, names);
  return value ? *value : root.at(names.front());
}

void set_eucm_of(CameraModel& camera, const YamlValue& section) {
  const YamlValue intrinsics = section.at("intrinsics");
  const auto v = intrinsics.numbers();
  if (v.size() != 6) intrinsics.fail("[alpha, beta, fx, fy, cx, cy] is expected");
  camera.fx = v[2], camera.fy = v[3], camera.cx = v[4], camera.cy = v[5];
  set_eucm(camera, intrinsics, v[0], v[1]);
}

// Kalibr's projection and distortion models as one lens, its first numbers before fx fy cx cy.
void set_kalibr_lens(CameraModel& camera, const YamlValue& section) {
  const YamlValue model = section.at("camera_model"), intrinsics = section.at("intrinsics");
  const std::string name = model.text();
  const auto found = lens_named(LensFile::kKalibr, name);
  if (!found && name == "eucm") return set_eucm_of(camera, section);
  if (!found) {
    auto names = lens_names(LensFile::kKalibr);
    names.emplace_back("eucm");
    model.fail("the camera model '" + name + "' is not supported, only " + listed(names) + " are");
  }
  const LensTraits& lens = lens_traits(found->model);
  const std::size_t before = found->form.before;
  const auto v = intrinsics.numbers();
  if (v.size() != before + 4) {
    std::string terms;
    for (std::size_t i = 0; i < before; ++i) terms += std::string(lens.terms[i]) + ", ";
    intrinsics.fail("[" + terms + "fx, fy, cx, cy] is expected");
  }
  camera.fx = v[before], camera.fy = v[before + 1], camera.cx = v[before + 2], camera.cy = v[before + 3];
  const auto coefficients = section.find("distortion_coeffs");
  auto k = coefficients ? coefficients->numbers() : std::vector<double>();
  if (before == 0) {
    const YamlValue distortion = section.at("distortion_model");
    if (distortion.text() != "fov") return set_distortion(camera, distortion, distortion.text(), k);
    if (k.size() != 1) section.at("distortion_coeffs").fail("one number is expected, the angle w of the lens");
    return set_fit(camera, section, "fov", field_of_view_lens(k.front()));
  }
  if (const auto distortion = section.find("distortion_model")) {
    const std::string bent = distortion->text();
    if (bent != "none" && bent != found->form.distortion) {
      distortion->fail("the distortion model '" + bent + "' is not supported with the camera model '" + name + "'");
    }
  }
  if (k.empty()) k.resize(found->form.terms - before);
  k.insert(k.begin(), v.begin(), v.begin() + static_cast<std::ptrdiff_t>(before));
  set_distortion(camera, section, std::string(lens.name()), k);
}

}  // namespace

CameraModel read_plain(const YamlValue& root) {
  root.allow_only({"width", "height", "fx", "fy", "cx", "cy", "distortion_model", "distortion"});
  CameraModel camera;
  camera.width_px = pixels(root.at("width"));
  camera.height_px = pixels(root.at("height"));
  camera.fx = root.at("fx").number();
  camera.fy = root.at("fy").number();
  camera.cx = root.at("cx").number();
  camera.cy = root.at("cy").number();
  const auto model = root.find("distortion_model");
  const auto distortion = root.find("distortion");
  if (distortion && !model) root.at("distortion_model");
  if (!model) return camera;
  const bool none = model->text() == "none";
  set_distortion(camera, *model, model->text(),
                 none && !distortion ? std::vector<double>() : root.at("distortion").numbers());
  return camera;
}

// YAML has many words for no.
bool says_yes(const YamlValue& value) {
  constexpr std::array kNo{"0", "false", "no", "off", "n"};
  return std::ranges::find(kNo, lower(value.text())) == kNo.end();
}

CameraModel read_opencv(const YamlValue& root) {
  CameraModel camera;
  if (const auto size = first_of(root, {"image_size", "imageSize"}); size && size->is_sequence()) {
    set_size(camera, *size);
  } else {
    camera.width_px = pixels(required(root, {"image_width", "image_Width", "imageWidth", "width"}));
    camera.height_px = pixels(required(root, {"image_height", "image_Height", "imageHeight", "height"}));
  }
  set_camera_matrix(camera, required(root, {"camera_matrix", "cameraMatrix", "Camera_Matrix", "K"}));
  const auto distortion = first_of(root, {"distortion_coefficients", "Distortion_Coefficients", "distCoeffs",
                                          "dist_coeffs", "dist_coeff", "dist", "distortion", "D"});
  if (!distortion) root.fail("the key 'distortion_coefficients' is missing");
  const auto fisheye = root.find("fisheye_model");
  const bool is_fisheye = fisheye && says_yes(*fisheye);
  set_distortion(camera, *distortion, is_fisheye ? "equidistant" : "radtan", matrix_data(*distortion));
  return camera;
}

CameraModel read_orb_slam(const YamlValue& root) {
  // Nested, as stella_vslam has it today, the keys are without "Camera.".
  const auto nested = root.find("Camera");
  const YamlValue& from = nested ? *nested : root;
  const std::string of_camera = nested ? "" : "Camera.", lens = root.has("Camera1.fx") ? "Camera1." : of_camera;
  CameraModel camera;
  camera.width_px = pixels(required(from, {of_camera + "width", of_camera + "cols"}));
  camera.height_px = pixels(required(from, {of_camera + "height", of_camera + "rows"}));
  camera.fx = from.at(lens + "fx").number();
  camera.fy = from.at(lens + "fy").number();
  camera.cx = from.at(lens + "cx").number();
  camera.cy = from.at(lens + "cy").number();
  const auto type = first_of(from, {of_camera + "type", of_camera + "model"});
  const std::string model = type ? type->text() : "PinHole";
  const auto coefficient = [&](std::string_view name) {
    const auto value = from.find(lens + std::string(name));
    return value ? value->number() : 0.0;
  };
  if (model == "Rectified") return camera;
  const auto found = lens_named(LensFile::kOrbSlam, model);
  if (!found) {
    auto names = lens_names(LensFile::kOrbSlam);
    names.emplace_back("Rectified");
    type->fail("the camera model '" + model + "' is not supported, only " + listed(names) + " are");
  }
  const LensTraits& traits = lens_traits(found->model);
  for (const char* tangential : {"p1", "p2"}) {
    const bool known = std::find(traits.terms.begin(), traits.terms.end(), tangential) != traits.terms.end();
    if (!known && coefficient(tangential) != 0)
      from.at(lens + tangential).fail("is no term of the lens '" + model + "'");
  }
  std::vector<double> k;
  for (std::size_t i = 0; i < found->form.terms; ++i) k.push_back(coefficient(traits.terms[i]));
  set_distortion(camera, root, std::string(traits.name()), k);
  return camera;
}

namespace {

// Its lens is that of the whole sensor; its images may be a part of that (which is told), in which pixels were taken
// together.
bool take_region(CameraModel& camera, const YamlValue& root) {
  const auto count = [](const std::optional<YamlValue>& value, int fallback) {
    return value ? std::max(fallback, pixels(*value)) : fallback;
  };
  bool part = false;
  if (const auto region = root.find("roi"); region && region->is_map()) {
    const int x = count(region->find("x_offset"), 0), y = count(region->find("y_offset"), 0);
    const int width = count(region->find("width"), 0), height = count(region->find("height"), 0);
    if (width > 0 && height > 0) {
      part = width < camera.width_px || height < camera.height_px;
      camera.width_px = width, camera.height_px = height;
      camera.cx -= x, camera.cy -= y;
    }
  }
  const int along_x = count(root.find("binning_x"), 1), along_y = count(root.find("binning_y"), 1);
  camera.width_px /= along_x, camera.height_px /= along_y;
  camera.fx /= along_x, camera.fy /= along_y;
  // The centre of the first pixel is that of those that it is made of.
  camera.cx = (camera.cx + 0.5) / along_x - 0.5;
  camera.cy = (camera.cy + 0.5) / along_y - 0.5;
  return part;
}

}  // namespace

SensorCamera read_ros(const YamlValue& root) {
  CameraModel camera;
  camera.width_px = pixels(required(root, {"image_width", "width"}));
  camera.height_px = pixels(required(root, {"image_height", "height"}));
  set_camera_matrix(camera, required(root, {"camera_matrix", "k", "K"}));
  const auto coefficients = required(root, {"distortion_coefficients", "d", "D"});
  const YamlValue model = root.at("distortion_model");
  const auto values = matrix_data(coefficients);
  // An undistorted camera is published with an empty model and no coefficients.
  set_distortion(camera, model, model.text().empty() ? "none" : model.text(), values);
  const bool part = take_region(camera, root);
  return {camera, part};
}

CameraModel read_kalibr(const YamlValue& root, const std::string& camera_name) {
  std::string names;
  for (const std::string& key : root.keys()) {
    if (key.starts_with("cam")) names += (names.empty() ? "" : ", ") + key;
  }
  if (camera_name.empty() && names.find(',') != std::string::npos) root.fail(several_cameras(names));
  if (!camera_name.empty() && !root.has(camera_name)) {
    root.fail("there is no camera '" + camera_name + "', of these there are: " + names);
  }
  const YamlValue section = root.at(camera_name.empty() ? root.keys().front() : camera_name);
  CameraModel camera;
  set_size(camera, section.at("resolution"));
  set_kalibr_lens(camera, section);
  return camera;
}

CameraModel read_euroc(const YamlValue& root) {
  const auto type = root.find("sensor_type");  // Kimera leaves it out
  if (type && type->text() != "camera") type->fail("the sensor is a '" + type->text() + "', not a camera");
  const YamlValue model = root.at("camera_model");
  if (model.text() != "pinhole") {
    model.fail("the camera model '" + model.text() + "' is not supported, only pinhole is");
  }
  CameraModel camera;
  set_size(camera, root.at("resolution"));
  set_intrinsics(camera, root.at("intrinsics"));
  const YamlValue distortion = root.at("distortion_model");
  set_distortion(camera, distortion, distortion.text(), root.at("distortion_coefficients").numbers());
  return camera;
}

}  // namespace coslam::calibration
