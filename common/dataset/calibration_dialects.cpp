// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/dataset/calibration_dialects.h"

#include <algorithm>
#include <map>

namespace coslam::calibration {
namespace {

int pixels(const YamlValue& value) { return static_cast<int>(std::clamp<std::int64_t>(value.integer(), -1, 1 << 20)); }

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

// A matrix is a list, or a map with its elements under `data`.
std::vector<double> matrix_data(const YamlValue& value) {
  return value.is_map() ? value.at("data").numbers() : value.numbers();
}

void set_camera_matrix(CameraModel& camera, const YamlValue& value) {
  const auto k = matrix_data(value);
  if (k.size() != 9) value.fail("nine elements of a 3x3 matrix are expected");
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

void set_radtan(CameraModel& camera, const YamlValue& place, std::vector<double> k) {
  while (k.size() > 8 && k.back() == 0) k.pop_back();
  if (k.size() > 8) place.fail("thin prism and tilted sensor coefficients are not supported");
  const bool all_zero = std::all_of(k.begin(), k.end(), [](double v) { return v == 0; });
  if (!all_zero && k.size() != 4 && k.size() != 5 && k.size() != 8) {
    place.fail(std::to_string(k.size()) + " radtan coefficients, 4, 5 or 8 are expected (k1 k2 p1 p2 k3 k4 k5 k6)");
  }
  if (all_zero) return;
  camera.distortion = DistortionModel::kRadTan;
  std::copy(k.begin(), k.end(), camera.coefficients.begin());
}

void set_exactly(CameraModel& camera, const YamlValue& place, DistortionModel model, const char* expected,
                 const std::vector<double>& k, std::size_t count) {
  if (k.size() != count) place.fail(std::string(expected) + " are expected");
  camera.distortion = model;
  std::copy(k.begin(), k.end(), camera.coefficients.begin());
}

// The files give the focal lengths of the sphere's image, CameraModel those of the middle.
void set_sphere(CameraModel& camera, const YamlValue& place, DistortionModel model, const char* expected,
                const std::vector<double>& k, std::size_t count) {
  set_exactly(camera, place, model, expected, k, count);
  if (!(k[0] > -1)) place.fail("xi of the lens must be above -1");
  camera.fx /= 1 + k[0];
  camera.fy /= 1 + k[0];
}

// Kalibr's projection and distortion models as one lens, its first numbers before fx fy cx cy.
void set_kalibr_lens(CameraModel& camera, const YamlValue& section) {
  const YamlValue model = section.at("camera_model"), intrinsics = section.at("intrinsics");
  const std::string name = model.text();
  const std::size_t before = name == "ds" ? 2 : name == "omni" ? 1 : 0;
  if (before == 0 && name != "pinhole") {
    model.fail("the camera model '" + name + "' is not supported, only pinhole, ds and omni are");
  }
  const auto v = intrinsics.numbers();
  if (v.size() != before + 4) {
    intrinsics.fail(before == 2   ? "[xi, alpha, fx, fy, cx, cy] is expected"
                    : before == 1 ? "[xi, fx, fy, cx, cy] is expected"
                                  : "[fx, fy, cx, cy] is expected");
  }
  camera.fx = v[before], camera.fy = v[before + 1], camera.cx = v[before + 2], camera.cy = v[before + 3];
  const auto coefficients = section.find("distortion_coeffs");
  auto k = coefficients ? coefficients->numbers() : std::vector<double>();
  if (before == 0) {
    const YamlValue distortion = section.at("distortion_model");
    return set_distortion(camera, distortion, distortion.text(), k);
  }
  if (const auto distortion = section.find("distortion_model")) {
    const std::string bent = distortion->text();
    if (bent != "none" && !(name == "omni" && bent == "radtan")) {
      distortion->fail("the distortion model '" + bent + "' is not supported with the camera model '" + name + "'");
    }
  }
  if (before == 1) k.resize(k.empty() ? 4 : k.size());
  k.insert(k.begin(), v.begin(), v.begin() + static_cast<std::ptrdiff_t>(before));
  set_distortion(camera, section, name, k);
}

}  // namespace

void set_distortion(CameraModel& camera, const YamlValue& place, const std::string& model,
                    const std::vector<double>& coefficients) {
  static const std::map<std::string, DistortionModel> kModels = {
      {"none", DistortionModel::kNone},
      {"radtan", DistortionModel::kRadTan},
      {"radial-tangential", DistortionModel::kRadTan},
      {"plumb_bob", DistortionModel::kRadTan},
      {"rational_polynomial", DistortionModel::kRadTan},
      {"equidistant", DistortionModel::kEquidistant},
      {"equi", DistortionModel::kEquidistant},
      {"fisheye", DistortionModel::kEquidistant},
      {"KannalaBrandt8", DistortionModel::kEquidistant},
      {"double_sphere", DistortionModel::kDoubleSphere},
      {"ds", DistortionModel::kDoubleSphere},
      {"omni", DistortionModel::kOmni},
      {"mei", DistortionModel::kOmni},
      {"unknown", DistortionModel::kUnknown},
  };
  const auto found = kModels.find(model);
  if (found == kModels.end()) {
    place.fail("the distortion model '" + model +
               "' is not supported, only none, radtan, equidistant, double_sphere, omni and unknown are");
  }
  camera.distortion = DistortionModel::kNone;
  camera.coefficients.fill(0);
  switch (found->second) {
    case DistortionModel::kNone:
    case DistortionModel::kUnknown:
      if (!coefficients.empty()) place.fail("the distortion model '" + model + "' has no coefficients");
      camera.distortion = found->second;
      return;
    case DistortionModel::kRadTan:
      return set_radtan(camera, place, coefficients);
    case DistortionModel::kEquidistant:
      return set_exactly(camera, place, found->second, "4 equidistant coefficients (k1 k2 k3 k4)", coefficients, 4);
    case DistortionModel::kDoubleSphere:
      return set_sphere(camera, place, found->second, "2 double_sphere coefficients (xi alpha)", coefficients, 2);
    case DistortionModel::kOmni:
      return set_sphere(camera, place, found->second, "5 omni coefficients (xi k1 k2 p1 p2)", coefficients, 5);
  }
}

double sphere_scale(const CameraModel& camera) {
  const bool sphere =
      camera.distortion == DistortionModel::kDoubleSphere || camera.distortion == DistortionModel::kOmni;
  return sphere ? 1 + camera.coefficients[0] : 1.0;
}

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

CameraModel read_opencv(const YamlValue& root) {
  CameraModel camera;
  if (const auto size = first_of(root, {"image_size", "imageSize"}); size && size->is_sequence()) {
    set_size(camera, *size);
  } else {
    camera.width_px = pixels(required(root, {"image_width", "image_Width", "imageWidth", "width"}));
    camera.height_px = pixels(required(root, {"image_height", "image_Height", "imageHeight", "height"}));
  }
  set_camera_matrix(camera, required(root, {"camera_matrix", "cameraMatrix", "Camera_Matrix", "K"}));
  const auto distortion = first_of(
      root, {"distortion_coefficients", "Distortion_Coefficients", "distCoeffs", "dist_coeffs", "distortion", "D"});
  if (!distortion) root.fail("the key 'distortion_coefficients' is missing");
  const auto fisheye = root.find("fisheye_model");
  const bool is_fisheye = fisheye && fisheye->text() != "0" && fisheye->text() != "false";
  set_distortion(camera, *distortion, is_fisheye ? "equidistant" : "radtan", matrix_data(*distortion));
  return camera;
}

CameraModel read_orb_slam(const YamlValue& root) {
  const std::string lens = root.has("Camera1.fx") ? "Camera1." : "Camera.";
  CameraModel camera;
  camera.width_px = pixels(root.at("Camera.width"));
  camera.height_px = pixels(root.at("Camera.height"));
  camera.fx = root.at(lens + "fx").number();
  camera.fy = root.at(lens + "fy").number();
  camera.cx = root.at(lens + "cx").number();
  camera.cy = root.at(lens + "cy").number();
  const auto type = root.find("Camera.type");
  const std::string model = type ? type->text() : "PinHole";
  const auto coefficient = [&](const char* name) {
    const auto value = root.find(lens + name);
    return value ? value->number() : 0.0;
  };
  if (model == "Rectified") return camera;
  if (model == "KannalaBrandt8") {
    set_distortion(camera, root, model, {coefficient("k1"), coefficient("k2"), coefficient("k3"), coefficient("k4")});
  } else if (model == "PinHole" || model == "Pinhole") {
    set_distortion(camera, root, "radtan",
                   {coefficient("k1"), coefficient("k2"), coefficient("p1"), coefficient("p2"), coefficient("k3")});
  } else {
    type->fail("the camera model '" + model + "' is not supported, only PinHole, Rectified and KannalaBrandt8 are");
  }
  return camera;
}

CameraModel read_ros(const YamlValue& root) {
  CameraModel camera;
  camera.width_px = pixels(required(root, {"image_width", "width"}));
  camera.height_px = pixels(required(root, {"image_height", "height"}));
  set_camera_matrix(camera, required(root, {"camera_matrix", "k", "K"}));
  const auto coefficients = required(root, {"distortion_coefficients", "d", "D"});
  const YamlValue model = root.at("distortion_model");
  const auto values = matrix_data(coefficients);
  // An undistorted camera is published with an empty model and no coefficients.
  set_distortion(camera, model, model.text().empty() && values.empty() ? "none" : model.text(), values);
  return camera;
}

CameraModel read_kalibr(const YamlValue& root, const std::string& camera_name) {
  const YamlValue section = root.at(camera_name.empty() ? root.keys().front() : camera_name);
  CameraModel camera;
  set_size(camera, section.at("resolution"));
  set_kalibr_lens(camera, section);
  return camera;
}

CameraModel read_euroc(const YamlValue& root) {
  const YamlValue type = root.at("sensor_type");
  if (type.text() != "camera") type.fail("the sensor is a '" + type.text() + "', not a camera");
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
