// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <fstream>
#include <map>

#include "common/base/error.h"
#include "common/base/text.h"
#include "common/dataset/calibration_dialects.h"

namespace coslam::calibration {
namespace {

struct Layout {
  bool one_focal;
  DistortionModel distortion;
  int coefficients;
};

const std::map<std::string, Layout, std::less<>> kLayouts = {
    {"SIMPLE_PINHOLE", {true, DistortionModel::kNone, 0}},
    {"PINHOLE", {false, DistortionModel::kNone, 0}},
    {"SIMPLE_RADIAL", {true, DistortionModel::kRadTan, 1}},
    {"RADIAL", {true, DistortionModel::kRadTan, 2}},
    {"OPENCV", {false, DistortionModel::kRadTan, 4}},
    {"FULL_OPENCV", {false, DistortionModel::kRadTan, 8}},
    {"OPENCV_FISHEYE", {false, DistortionModel::kEquidistant, 4}},
};

CameraModel parse_camera(const std::vector<std::string_view>& fields, const std::string& where) {
  const auto layout = kLayouts.find(fields[1]);
  if (layout == kLayouts.end()) {
    throw UserError(where + "the camera model '" + std::string(fields[1]) + "' is not supported");
  }
  std::vector<double> v;
  for (std::size_t i = 2; i < fields.size(); ++i) {
    const auto number = parse_double(fields[i]);
    if (!number) throw UserError(where + "'" + std::string(fields[i]) + "' is not a number");
    v.push_back(*number);
  }
  const auto& [one_focal, distortion, coefficients] = layout->second;
  const std::size_t first = 2 + (one_focal ? 3 : 4);
  if (v.size() != first + static_cast<std::size_t>(coefficients)) {
    throw UserError(where + "the number of parameters does not fit the camera model");
  }
  CameraModel camera;
  camera.width_px = static_cast<int>(std::clamp(v[0], -1.0, 1e6));
  camera.height_px = static_cast<int>(std::clamp(v[1], -1.0, 1e6));
  camera.fx = v[2];
  camera.fy = one_focal ? v[2] : v[3];
  // The centre of COLMAP's first pixel is (0.5, 0.5), ours is (0, 0).
  camera.cx = v[first - 2] - 0.5;
  camera.cy = v[first - 1] - 0.5;
  camera.distortion = distortion;
  std::copy(v.begin() + static_cast<std::ptrdiff_t>(first), v.end(), camera.coefficients.begin());
  return camera;
}

}  // namespace

CameraModel read_colmap(const std::filesystem::path& cameras_txt, const std::string& camera) {
  std::ifstream stream(cameras_txt);
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    const auto fields = split_fields(line);
    if (fields.empty() || fields[0].starts_with('#')) continue;
    const std::string where = cameras_txt.string() + ":" + std::to_string(number) + ": ";
    if (fields.size() < 5) throw UserError(where + "not a line `ID MODEL WIDTH HEIGHT PARAMS`");
    if (camera.empty() || fields[0] == camera) return parse_camera(fields, where);
  }
  throw UserError(cameras_txt.string() + ": there is no camera" + (camera.empty() ? "" : " '" + camera + "'") +
                  " in it");
}

}  // namespace coslam::calibration
