// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>

#include "common/base/error.h"
#include "common/base/log.h"
#include "common/base/text.h"
#include "common/dataset/calibration_dialects.h"
#include "common/dataset/lens_fit.h"

namespace coslam::calibration {
namespace {

// These two are not of our lenses: the nearest one stands for them.
constexpr const char* kThinPrism = "THIN_PRISM_FISHEYE";
constexpr const char* kFieldOfView = "FOV";

std::optional<NamedLens> colmap_lens(std::string_view name) {
  const auto found = lens_named(LensFile::kColmap, name);
  if (found) return found;
  if (name == kThinPrism) return NamedLens{DistortionModel::kEquidistant, {LensFile::kColmap, name, 8}};
  if (name == kFieldOfView) return NamedLens{DistortionModel::kNone, {LensFile::kColmap, name, 1}};
  return std::nullopt;
}

// Has k1 k2 p1 p2 k3 k4 sx1 sy1. What is left out moves places by p and s times the squared angle, at the farthest
// corner most.
CameraModel without_prism(CameraModel camera, const std::string& place) {
  const auto k = camera.coefficients;
  const double p = std::abs(k[2]) + std::abs(k[3]), s = std::abs(k[6]) + std::abs(k[7]);
  camera.coefficients = {k[0], k[1], k[4], k[5]};
  const double corner = farthest_corner(camera);
  const FittedLens fit{camera, std::max(camera.fx, camera.fy) * (3 * p + s) * corner * corner};
  if (p + s > 0) log_warn(place + fit_said(kThinPrism, fit));
  return camera;
}

CameraModel parse_camera(const std::vector<std::string_view>& fields, const std::string& place) {
  const auto lens = colmap_lens(fields[1]);
  if (!lens) {
    throw UserError(place + "the camera model '" + std::string(fields[1]) + "' is not supported");
  }
  std::vector<double> v;
  for (std::size_t i = 2; i < fields.size(); ++i) {
    const auto number = parse_double(fields[i]);
    if (!number) throw UserError(place + "'" + std::string(fields[i]) + "' is not a number");
    v.push_back(*number);
  }
  const bool one_focal = lens->form.one_focal;
  const std::size_t first = 2 + (one_focal ? 3 : 4);
  if (v.size() != first + lens->form.terms) {
    throw UserError(place + "the number of parameters does not fit the camera model");
  }
  CameraModel camera;
  camera.width_px = static_cast<int>(std::clamp(v[0], -1.0, 1e6));
  camera.height_px = static_cast<int>(std::clamp(v[1], -1.0, 1e6));
  camera.fx = v[2];
  camera.fy = one_focal ? v[2] : v[3];
  // The centre of COLMAP's first pixel is (0.5, 0.5), ours is (0, 0).
  camera.cx = v[first - 2] - 0.5;
  camera.cy = v[first - 1] - 0.5;
  if (fields[1] == kFieldOfView) {
    const FittedLens fit = fit_equidistant(camera, field_of_view_lens(v[first]));
    log_info(place + fit_said(kFieldOfView, fit));
    return fit.camera;
  }
  set_lens(camera, lens->model, {v.begin() + static_cast<std::ptrdiff_t>(first), v.end()});
  return fields[1] == kThinPrism ? without_prism(camera, place) : camera;
}

}  // namespace

CameraModel read_colmap(const std::filesystem::path& cameras_txt, const std::string& camera) {
  std::ifstream stream(cameras_txt);
  std::string line;
  std::string names;
  std::optional<CameraModel> found;
  for (int number = 1; std::getline(stream, line); ++number) {
    const auto fields = split_fields(line);
    if (fields.empty() || fields[0].starts_with('#')) continue;
    const std::string place = cameras_txt.string() + ":" + std::to_string(number) + ": ";
    if (fields.size() < 5) throw UserError(place + "not a line `ID MODEL WIDTH HEIGHT PARAMS`");
    if (!camera.empty() && fields[0] != camera) continue;
    if (!camera.empty() || !found) found = parse_camera(fields, place);
    names += (names.empty() ? "" : ", ") + std::string(fields[0]);
  }
  if (names.find(',') != std::string::npos) throw UserError(cameras_txt.string() + ": " + several_cameras(names));
  if (found) return *found;
  throw UserError(cameras_txt.string() + ": there is no camera" + (camera.empty() ? "" : " '" + camera + "'") +
                  " in it");
}

}  // namespace coslam::calibration
