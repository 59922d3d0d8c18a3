// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Calibrations as single programs write them.
#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <sstream>

#include "common/base/error.h"
#include "common/base/log.h"
#include "common/base/text.h"
#include "common/dataset/calibration_dialects.h"
#include "common/dataset/lens_fit.h"

namespace coslam::calibration {
namespace {

std::vector<double> numbers_at(const YamlValue& section, std::initializer_list<const char*> keys) {
  std::vector<double> out;
  for (const char* key : keys) out.push_back(section.at(key).number());
  return out;
}

void set_projection(CameraModel& camera, const std::vector<double>& fx_fy_cx_cy) {
  camera.fx = fx_fy_cx_cy[0], camera.fy = fx_fy_cx_cy[1], camera.cx = fx_fy_cx_cy[2], camera.cy = fx_fy_cx_cy[3];
}

}  // namespace

CameraModel read_camodocal(const YamlValue& root) {
  CameraModel camera;
  camera.width_px = pixels(root.at("image_width"));
  camera.height_px = pixels(root.at("image_height"));
  const YamlValue type = root.at("model_type"), projection = root.at("projection_parameters");
  const std::string model = type.text();
  if (model == "KANNALA_BRANDT") {
    set_projection(camera, numbers_at(projection, {"mu", "mv", "u0", "v0"}));
    set_distortion(camera, projection, "equidistant", numbers_at(projection, {"k2", "k3", "k4", "k5"}));
    return camera;
  }
  if (model != "PINHOLE" && model != "MEI") {
    type.fail("the camera model '" + model + "' is not supported, only PINHOLE, MEI and KANNALA_BRANDT are");
  }
  const YamlValue distortion = root.at("distortion_parameters");
  std::vector<double> k = numbers_at(distortion, {"k1", "k2", "p1", "p2"});
  if (model == "PINHOLE") {
    set_projection(camera, numbers_at(projection, {"fx", "fy", "cx", "cy"}));
    set_distortion(camera, distortion, "radtan", k);
    return camera;
  }
  set_projection(camera, numbers_at(projection, {"gamma1", "gamma2", "u0", "v0"}));
  k.insert(k.begin(), root.at("mirror_parameters").at("xi").number());
  set_distortion(camera, distortion, "omni", k);
  return camera;
}

CameraModel read_maplab(const YamlValue& root, const std::string& camera_name) {
  std::vector<YamlValue> cameras;
  std::string names;
  for (const YamlValue& item : root.at("cameras").items()) {
    const YamlValue camera = item.find("camera").value_or(item);
    const std::string label = camera.at("label").text();
    names += (names.empty() ? "" : ", ") + label;
    if (camera_name.empty() || label == camera_name) cameras.push_back(camera);
  }
  if (cameras.empty())
    root.at("cameras").fail("there is no camera '" + camera_name + "', of these there are: " + names);
  if (cameras.size() > 1) root.fail(several_cameras(names));
  const YamlValue& from = cameras.front();
  CameraModel camera;
  camera.width_px = pixels(from.at("image_width"));
  camera.height_px = pixels(from.at("image_height"));
  const YamlValue type = from.at("type"), intrinsics = from.at("intrinsics").at("data");
  if (type.text() != "pinhole") type.fail("the camera model '" + type.text() + "' is not supported, only pinhole is");
  const auto v = intrinsics.numbers();
  if (v.size() != 4) intrinsics.fail("[fx, fy, cx, cy] is expected");
  set_projection(camera, v);
  const YamlValue distortion = from.at("distortion"), model = distortion.at("type");
  const auto parameters = distortion.find("parameters");
  const auto k = parameters ? parameters->at("data").numbers() : std::vector<double>();
  if (model.text() == "fisheye") {  // so maplab calls the field-of-view lens
    if (k.size() != 1) distortion.fail("one number is expected");
    const FittedLens fit = fit_equidistant(camera, field_of_view_lens(k.front()));
    log_info(root.file().string() + ": " + fit_said("fisheye", fit));
    return fit.camera;
  }
  set_distortion(camera, model, model.text(), k);
  return camera;
}

namespace {

std::vector<double> numbers_in(const YamlValue& row, std::size_t count) {
  const std::string text = row.text();
  std::vector<double> out;
  for (const std::string_view field : split_fields(text)) {
    if (const auto number = parse_double(field)) out.push_back(*number);
  }
  if (out.size() != count) row.fail(std::to_string(count) + " numbers are expected");
  return out;
}

}  // namespace

// Of rectified images: `P_rect_00: 12 numbers`, row by row, and `S_rect_00: width height`; or `P0:` and no size.
CameraModel read_kitti(const YamlValue& root, const std::string& camera_name) {
  std::vector<std::string> cameras;
  std::string names;
  for (const std::string& key : root.keys()) {
    if (!key.starts_with("P_rect_") && (key.size() != 2 || key[0] != 'P')) continue;
    names += (names.empty() ? "" : ", ") + key;
    if (camera_name.empty() || key == camera_name) cameras.push_back(key);
  }
  if (cameras.empty()) root.fail("there is no camera '" + camera_name + "', of these there are: " + names);
  if (cameras.size() > 1) root.fail(several_cameras(names));
  const std::string& name = cameras.front();
  const std::vector<double> p = numbers_in(root.at(name), 12);
  CameraModel camera;
  set_projection(camera, {p[0], p[5], p[2], p[6]});
  const auto size = root.find("S" + name.substr(1));
  if (!size) {
    root.at(name).fail("the size of the images is not in it: write `width:`, `height:` and `fx: " +
                       format_double(p[0]) + "`, `fy: " + format_double(p[5]) + "`, `cx: " + format_double(p[2]) +
                       "`, `cy: " + format_double(p[6]) + "` into a file of their own, a line each");
  }
  const std::vector<double> width_height = numbers_in(*size, 2);
  camera.width_px = static_cast<int>(std::clamp(width_height[0], 0.0, 1e6));
  camera.height_px = static_cast<int>(std::clamp(width_height[1], 0.0, 1e6));
  return camera;
}

CameraModel read_ost(const std::filesystem::path& file) {
  // Names, numbers and empty lines; names are those of what follows.
  std::ifstream stream(file);
  std::map<std::string, std::vector<double>, std::less<>> values;
  std::string line, name;
  while (std::getline(stream, line)) {
    const std::string_view text = trimmed(line);
    if (text.empty() || text.front() == '#' || text.front() == '[') continue;
    std::vector<double> numbers;
    for (const std::string_view field : split_fields(text)) {
      if (const auto number = parse_double(field)) numbers.push_back(*number);
    }
    if (numbers.empty()) {
      name = text;
    } else {
      auto& at = values[name];
      at.insert(at.end(), numbers.begin(), numbers.end());
    }
  }
  std::ostringstream text;
  text.precision(17);
  const auto put = [&](const char* key, const char* source_key, std::size_t count) {
    const auto& v = values[source_key];
    if (count > 0 && v.size() != count) {
      throw UserError(file.string() + ": of '" + source_key + "' there are " + std::to_string(v.size()) +
                      " numbers, not " + std::to_string(count));
    }
    text << key << ": ";
    if (count != 1) text << '[';
    for (std::size_t i = 0; i < v.size(); ++i) text << (i == 0 ? "" : ", ") << v[i];
    text << (count != 1 ? "]\n" : "\n");
  };
  put("width", "width", 1);
  put("height", "height", 1);
  put("k", "camera matrix", 9);
  put("d", "distortion", 0);
  const std::size_t terms = values["distortion"].size();
  text << "distortion_model: " << (terms == 4 || terms == 5 || terms == 0 ? "plumb_bob" : "rational_polynomial")
       << '\n';
  std::istringstream as_yaml(text.str());
  return read_ros(YamlValue::parse(as_yaml, file)).model;
}

// A focal length and a principal point below 1 are shares of the size.
CameraModel dso_pinhole(std::vector<double> v, const std::vector<double>& size) {
  CameraModel camera;
  camera.width_px = static_cast<int>(std::clamp(size[0], 0.0, 1e6));
  camera.height_px = static_cast<int>(std::clamp(size[1], 0.0, 1e6));
  if (v[2] < 1 && v[3] < 1) {
    v[0] *= size[0], v[2] = v[2] * size[0] - 0.5;
    v[1] *= size[1], v[3] = v[3] * size[1] - 0.5;
  }
  set_projection(camera, v);
  return camera;
}

// `[Model] fx fy cx cy [terms]`, and the size.
CameraModel read_dso(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string first, second;
  std::getline(stream, first);
  std::getline(stream, second);
  auto fields = split_fields(first);
  std::string model;
  if (!fields.empty() && !parse_double(fields.front())) {
    model = fields.front();
    fields.erase(fields.begin());
  }
  std::vector<double> v, size;
  for (const std::string_view field : fields) v.push_back(parse_double(field).value_or(0));
  for (const std::string_view field : split_fields(second)) size.push_back(parse_double(field).value_or(0));
  if (v.size() < 4 || size.size() != 2)
    throw UserError(file.string() + ": `fx fy cx cy ...` and `width height` are expected");
  CameraModel camera = dso_pinhole(v, size);
  const std::vector<double> k(v.begin() + 4, v.end());
  if (model.empty()) model = k.size() == 1 ? "FOV" : "RadTan";
  const bool none = std::ranges::all_of(k, [](double value) { return value == 0; });
  const auto lens = lens_named(LensFile::kDso, model);
  if (none || (lens && lens->form.terms == 0)) return camera;
  if (lens && k.size() == lens->form.terms) {
    set_lens(camera, lens->model, k);
    return camera;
  }
  if (model == "FOV" && k.size() == 1) {
    const FittedLens fit = fit_equidistant(camera, field_of_view_lens(k.front()));
    log_info(file.string() + ": " + fit_said(model, fit));
    return fit.camera;
  }
  auto names = lens_names(LensFile::kDso);
  names.emplace_back("FOV");
  throw UserError(file.string() + ": the lens '" + model + "' with " + std::to_string(k.size()) +
                  " terms is not supported, only " + listed(names) + " are, FOV with one and those with four");
}

std::string several_cameras(const std::string& names) {
  return "there are several cameras in it (" + names + "): name one, as FILE#CAMERA";
}

}  // namespace coslam::calibration
