// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/calibrate/dialects.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "common/base/error.h"
#include "common/base/text.h"
#include "common/dataset/calibration.h"

namespace coslam {
namespace {

using enum DistortionModel;

// How many coefficients a lens needs of its model.
int used(const CameraModel& c) {
  int n = static_cast<int>(c.coefficients.size());
  while (n > 0 && c.coefficients[static_cast<std::size_t>(n - 1)] == 0) --n;
  return n;
}

std::string list(const CameraModel& c, int count) {
  std::string out;
  for (int i = 0; i < count; ++i) {
    out += (i == 0 ? "" : ", ") + format_double(c.coefficients[static_cast<std::size_t>(i)]);
  }
  return out;
}

std::string matrix(const CameraModel& c) {
  return "[" + format_double(c.fx) + ", 0, " + format_double(c.cx) + ", 0, " + format_double(c.fy) + ", " +
         format_double(c.cy) + ", 0, 0, 1]";
}

// What a dialect has: radial terms with tangential ones, up to so many coefficients, and the equidistant lens.
struct Reach {
  int radtan = 0;
  bool spheres = false;  // double sphere and omni, too
};

// The camera itself where the dialect has it, else the nearest that it has.
NearestCamera within(const CameraModel& c, const Reach& reach) {
  const bool has = c.distortion == kNone || c.distortion == kEquidistant ||
                   (c.distortion == kRadTan && used(c) <= reach.radtan) ||
                   (reach.spheres && (c.distortion == kDoubleSphere || c.distortion == kOmni));
  if (has) return {c, 0};
  const NearestCamera radtan = nearest_camera(c, kRadTan, reach.radtan), wide = nearest_camera(c, kEquidistant, 4);
  return radtan.miss_px < wide.miss_px ? radtan : wide;
}

std::string opencv(const CameraModel& c) {
  const int count = c.distortion == kEquidistant ? 4 : used(c) <= 5 ? 5 : 8;
  return "%YAML:1.0\n---\nimage_width: " + std::to_string(c.width_px) +
         "\nimage_height: " + std::to_string(c.height_px) + (c.distortion == kEquidistant ? "\nfisheye_model: 1" : "") +
         "\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: " + matrix(c) +
         "\ndistortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: " + std::to_string(count) +
         "\n   dt: d\n   data: [" + list(c, count) + "]\n";
}

std::string ros(const CameraModel& c) {
  const bool wide = c.distortion == kEquidistant;
  const int count = wide ? 4 : used(c) <= 5 ? 5 : 8;
  return "image_width: " + std::to_string(c.width_px) + "\nimage_height: " + std::to_string(c.height_px) +
         "\ncamera_name: camera\ncamera_matrix:\n  rows: 3\n  cols: 3\n  data: " + matrix(c) + "\ndistortion_model: " +
         (wide         ? "equidistant"
          : count == 5 ? "plumb_bob"
                       : "rational_polynomial") +
         "\ndistortion_coefficients:\n  rows: 1\n  cols: " + std::to_string(count) + "\n  data: [" + list(c, count) +
         "]\nrectification_matrix:\n  rows: 3\n  cols: 3\n  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nprojection_matrix:\n"
         "  rows: 3\n  cols: 4\n  data: [" +
         format_double(c.fx) + ", 0, " + format_double(c.cx) + ", 0, 0, " + format_double(c.fy) + ", " +
         format_double(c.cy) + ", 0, 0, 0, 1, 0]\n";
}

std::string kalibr(const CameraModel& c) {
  const bool omni = c.distortion == kOmni, ds = c.distortion == kDoubleSphere;
  const double sphere = omni || ds ? 1 + c.coefficients[0] : 1;
  std::string before = omni ? format_double(c.coefficients[0]) + ", "
                       : ds ? format_double(c.coefficients[0]) + ", " + format_double(c.coefficients[1]) + ", "
                            : "";
  CameraModel bent = c;
  if (omni) std::copy(c.coefficients.begin() + 1, c.coefficients.begin() + 5, bent.coefficients.begin());
  if (c.distortion == kNone) bent.coefficients.fill(0);
  return "cam0:\n  camera_model: " +
         std::string(omni ? "omni"
                     : ds ? "ds"
                          : "pinhole") +
         "\n  intrinsics: [" + before + format_double(c.fx * sphere) + ", " + format_double(c.fy * sphere) + ", " +
         format_double(c.cx) + ", " + format_double(c.cy) + "]\n  distortion_model: " +
         (ds                             ? "none"
          : c.distortion == kEquidistant ? "equidistant"
                                         : "radtan") +
         "\n  distortion_coeffs: [" + (ds ? "" : list(bent, 4)) + "]\n  resolution: [" + std::to_string(c.width_px) +
         ", " + std::to_string(c.height_px) + "]\n";
}

std::string colmap(const CameraModel& c) {
  const bool wide = c.distortion == kEquidistant;
  const int count = c.distortion == kNone ? 0 : wide || used(c) <= 4 ? 4 : 8;
  std::string out = "# CAMERA_ID MODEL WIDTH HEIGHT PARAMS\n1 ";
  out += count == 0 ? "PINHOLE" : wide ? "OPENCV_FISHEYE" : count == 4 ? "OPENCV" : "FULL_OPENCV";
  out += " " + std::to_string(c.width_px) + " " + std::to_string(c.height_px);
  // The centre of COLMAP's first pixel is (0.5, 0.5).
  for (const double v : {c.fx, c.fy, c.cx + 0.5, c.cy + 0.5}) out += " " + format_double(v);
  for (int i = 0; i < count; ++i) out += " " + format_double(c.coefficients[static_cast<std::size_t>(i)]);
  return out + "\n";
}

std::string orbslam(const CameraModel& c) {
  const bool wide = c.distortion == kEquidistant;
  std::string out = "%YAML:1.0\nCamera.type: \"" + std::string(wide ? "KannalaBrandt8" : "PinHole") +
                    "\"\nCamera.fx: " + format_double(c.fx) + "\nCamera.fy: " + format_double(c.fy) +
                    "\nCamera.cx: " + format_double(c.cx) + "\nCamera.cy: " + format_double(c.cy);
  const std::array<const char*, 5> names = wide ? std::array<const char*, 5>{"k1", "k2", "k3", "k4", nullptr}
                                                : std::array<const char*, 5>{"k1", "k2", "p1", "p2", "k3"};
  for (std::size_t i = 0; i < names.size() && names[i] != nullptr; ++i) {
    out += "\nCamera." + std::string(names[i]) + ": " + format_double(c.distortion == kNone ? 0 : c.coefficients[i]);
  }
  return out + "\nCamera.width: " + std::to_string(c.width_px) + "\nCamera.height: " + std::to_string(c.height_px) +
         "\n";
}

struct Dialect {
  const char* name = nullptr;
  Reach reach;
  std::string (*write)(const CameraModel&) = nullptr;
};
constexpr int kAll = 8;
constexpr std::array<Dialect, 6> kDialects{{{"plain", {kAll, true}, plain_text},
                                            {"opencv", {kAll, false}, opencv},
                                            {"ros", {kAll, false}, ros},
                                            {"kalibr", {4, true}, kalibr},
                                            {"colmap", {kAll, false}, colmap},
                                            {"orbslam", {5, false}, orbslam}}};

}  // namespace

std::vector<std::string> calibration_dialects() {
  std::vector<std::string> out;
  out.reserve(kDialects.size());
  for (const Dialect& d : kDialects) out.emplace_back(d.name);
  return out;
}

WrittenCalibration written_calibration(const CameraModel& camera, const std::string& dialect) {
  const auto found = std::ranges::find(kDialects, dialect, [](const Dialect& d) { return std::string(d.name); });
  if (found == kDialects.end()) throw UserError("there is no dialect '" + dialect + "' of calibrations");
  CameraModel known = camera;
  if (known.distortion == kUnknown && dialect != "plain") known.distortion = kNone;
  const NearestCamera nearest = dialect == "plain" ? NearestCamera{known, 0} : within(known, found->reach);
  return {found->write(nearest.camera), nearest.camera, nearest.miss_px};
}

}  // namespace coslam
