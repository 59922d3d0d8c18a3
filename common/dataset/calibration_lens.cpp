// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Lenses of all dialects as those of a CameraModel.
#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "common/base/log.h"
#include "common/dataset/calibration_dialects.h"

namespace coslam::calibration {
namespace {

// The terms s1 to s4 of a thin prism, from the ninth on, move a place by them times the squared and the fourth power of
// its distance from the middle.
void leave_out_prism(const CameraModel& camera, const YamlValue& place, std::vector<double>* k) {
  k->resize(12);
  const double r2 = std::pow(farthest_corner(camera), 2);
  const double along_x = (*k)[8] * r2 + (*k)[9] * r2 * r2, along_y = (*k)[10] * r2 + (*k)[11] * r2 * r2;
  std::ostringstream miss;
  miss.precision(2);
  miss << std::hypot(camera.fx * along_x, camera.fy * along_y);
  log_warn(place.file().string() + ": the terms of a thin prism are left out, which is " + miss.str() +
           " pixels off in the farthest corner");
  k->resize(8);
}

void set_radtan(CameraModel& camera, const YamlValue& place, std::vector<double> k) {
  while (k.size() > 8 && k.back() == 0) k.pop_back();
  if (k.size() > 12) place.fail("coefficients of a tilted sensor are not supported");
  if (k.size() > 8) leave_out_prism(camera, place, &k);
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

}  // namespace

void set_fit(CameraModel& camera, const YamlValue& place, const char* model, const RadiusOfAngle& radius) {
  const FittedLens fit = fit_equidistant(camera, radius);
  log_info(place.file().string() + ": " + fit_said(model, fit));
  camera = fit.camera;
}

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
      if (std::ranges::any_of(coefficients, [](double k) { return k != 0; }))
        place.fail("the distortion model '" + model + "' has no coefficients");
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

void set_eucm(CameraModel& camera, const YamlValue& place, double alpha, double beta) {
  if (!(alpha >= 0 && alpha <= 1 && beta > 0)) place.fail("alpha from 0 to 1 and beta above 0 are expected");
  set_fit(camera, place, "eucm", extended_unified_lens(alpha, beta));
}

double sphere_scale(const CameraModel& camera) {
  const bool sphere =
      camera.distortion == DistortionModel::kDoubleSphere || camera.distortion == DistortionModel::kOmni;
  return sphere ? 1 + camera.coefficients[0] : 1.0;
}

}  // namespace coslam::calibration
