// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/calibrate/dialects.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "common/base/error.h"
#include "common/base/text.h"
#include "common/dataset/calibration.h"
#include "common/geometry/lens_forms.h"

namespace coslam {
namespace {

std::string list(const CameraModel& c, std::size_t first, std::size_t end) {
  std::string out;
  for (std::size_t i = first; i < end; ++i) out += (i == first ? "" : ", ") + format_double(c.coefficients[i]);
  return out;
}

std::string matrix(const CameraModel& c) {
  return "[" + format_double(c.fx) + ", 0, " + format_double(c.cx) + ", 0, " + format_double(c.fy) + ", " +
         format_double(c.cy) + ", 0, 0, 1]";
}

// The camera itself where such files have its lens, else the nearest of the two that files have for all others.
NearestCamera within(const CameraModel& c, LensFile file) {
  using enum DistortionModel;
  if (exact_form(file, c)) return {c, 0};
  const NearestCamera radtan = nearest_camera(c, kRadTan, static_cast<int>(most_terms(file, kRadTan)));
  const NearestCamera wide = nearest_camera(c, kEquidistant, static_cast<int>(most_terms(file, kEquidistant)));
  return radtan.miss_px < wide.miss_px ? radtan : wide;
}

std::string opencv(const CameraModel& c, const LensForm& form) {
  const std::string count = std::to_string(form.terms);
  return "%YAML:1.0\n---\nimage_width: " + std::to_string(c.width_px) +
         "\nimage_height: " + std::to_string(c.height_px) + (form.name == "fisheye" ? "\nfisheye_model: 1" : "") +
         "\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: " + matrix(c) +
         "\ndistortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: " + count + "\n   dt: d\n   data: [" +
         list(c, 0, form.terms) + "]\n";
}

std::string ros(const CameraModel& c, const LensForm& form) {
  return "image_width: " + std::to_string(c.width_px) + "\nimage_height: " + std::to_string(c.height_px) +
         "\ncamera_name: camera\ncamera_matrix:\n  rows: 3\n  cols: 3\n  data: " + matrix(c) +
         "\ndistortion_model: " + std::string(form.name) +
         "\ndistortion_coefficients:\n  rows: 1\n  cols: " + std::to_string(form.terms) + "\n  data: [" +
         list(c, 0, form.terms) +
         "]\nrectification_matrix:\n  rows: 3\n  cols: 3\n  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nprojection_matrix:\n"
         "  rows: 3\n  cols: 4\n  data: [" +
         format_double(c.fx) + ", 0, " + format_double(c.cx) + ", 0, 0, " + format_double(c.fy) + ", " +
         format_double(c.cy) + ", 0, 0, 0, 1, 0]\n";
}

std::string kalibr(const CameraModel& c, const LensForm& form) {
  return "cam0:\n  camera_model: " + std::string(form.name) + "\n  intrinsics: [" + list(c, 0, form.before) +
         (form.before > 0 ? ", " : "") + format_double(c.fx) + ", " + format_double(c.fy) + ", " + format_double(c.cx) +
         ", " + format_double(c.cy) + "]\n  distortion_model: " + std::string(form.distortion) +
         "\n  distortion_coeffs: [" + list(c, form.before, form.terms) + "]\n  resolution: [" +
         std::to_string(c.width_px) + ", " + std::to_string(c.height_px) + "]\n";
}

std::string colmap(const CameraModel& c, const LensForm& form) {
  std::string out = "# CAMERA_ID MODEL WIDTH HEIGHT PARAMS\n1 " + std::string(form.name) + " " +
                    std::to_string(c.width_px) + " " + std::to_string(c.height_px);
  // The centre of COLMAP's first pixel is (0.5, 0.5).
  for (const double v : {c.fx, c.fy, c.cx + 0.5, c.cy + 0.5}) out += " " + format_double(v);
  for (std::size_t i = 0; i < form.terms; ++i) out += " " + format_double(c.coefficients[i]);
  return out + "\n";
}

std::string orbslam(const CameraModel& c, const LensForm& form) {
  std::string out = "%YAML:1.0\nCamera.type: \"" + std::string(form.name) + "\"\nCamera.fx: " + format_double(c.fx) +
                    "\nCamera.fy: " + format_double(c.fy) + "\nCamera.cx: " + format_double(c.cx) +
                    "\nCamera.cy: " + format_double(c.cy);
  // A camera without distortion has the form of a lens whose terms are 0.
  const bool none = c.distortion == DistortionModel::kNone;
  const LensTraits& lens = lens_traits(none ? DistortionModel::kRadTan : c.distortion);
  for (std::size_t i = 0; i < form.terms; ++i) {
    out += "\nCamera." + std::string(lens.terms[i]) + ": " + format_double(c.coefficients[i]);
  }
  return out + "\nCamera.width: " + std::to_string(c.width_px) + "\nCamera.height: " + std::to_string(c.height_px) +
         "\n";
}

// Dialects beside our plain form.
struct Dialect {
  const char* name = nullptr;
  LensFile file = LensFile::kOpenCv;
  std::string (*write)(const CameraModel&, const LensForm&) = nullptr;  // the focal lengths are as such files have them
};
constexpr std::array<Dialect, 5> kDialects{{{"opencv", LensFile::kOpenCv, opencv},
                                            {"ros", LensFile::kRos, ros},
                                            {"kalibr", LensFile::kKalibr, kalibr},
                                            {"colmap", LensFile::kColmap, colmap},
                                            {"orbslam", LensFile::kOrbSlam, orbslam}}};

std::string text_of(CameraModel camera, const Dialect& dialect) {
  const auto form = exact_form(dialect.file, camera);
  const double scale = focal_in_files(camera);
  camera.fx *= scale;
  camera.fy *= scale;
  return dialect.write(camera, form.value());
}

}  // namespace

std::vector<std::string> calibration_dialects() {
  std::vector<std::string> out{"plain"};
  for (const Dialect& d : kDialects) out.emplace_back(d.name);
  return out;
}

WrittenCalibration written_calibration(const CameraModel& camera, const std::string& dialect) {
  if (dialect == "plain") return {plain_text(camera), camera, 0};
  const auto found = std::ranges::find(kDialects, dialect, [](const Dialect& d) { return std::string(d.name); });
  if (found == kDialects.end()) throw UserError("there is no dialect '" + dialect + "' of calibrations");
  CameraModel known = camera;
  if (known.guessed()) known.distortion = DistortionModel::kNone;
  const NearestCamera nearest = within(known, found->file);
  return {text_of(nearest.camera, *found), nearest.camera, nearest.miss_px};
}

}  // namespace coslam
