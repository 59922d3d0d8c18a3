// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Lenses of all dialects as those of a CameraModel.
#include <algorithm>
#include <cmath>
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

std::string expected_terms(const LensTraits& lens) {
  std::string text = std::to_string(lens.terms.size()) + " " + std::string(lens.name()) +
                     (lens.terms.size() == 1 ? " coefficient (" : " coefficients (");
  for (const std::string_view& term : lens.terms) text += (&term == lens.terms.begin() ? "" : " ") + std::string(term);
  return text + (lens.terms.size() == 1 ? ") is expected" : ") are expected");
}

void set_exactly(CameraModel& camera, const YamlValue& place, DistortionModel model, const std::vector<double>& k) {
  if (k.size() != lens_traits(model).terms.size()) place.fail(expected_terms(lens_traits(model)));
  LensTerms terms{};
  std::copy(k.begin(), k.end(), terms.begin());
  const auto problem = visit_lens(model, [&](auto lens) { return lens.problem(terms); });
  if (problem) place.fail(*problem);
  set_lens(camera, model, k);
}

}  // namespace

void set_fit(CameraModel& camera, const YamlValue& place, const char* model, const RadiusOfAngle& radius) {
  const FittedLens fit = fit_equidistant(camera, radius);
  log_info(place.file().string() + ": " + fit_said(model, fit));
  camera = fit.camera;
}

void set_distortion(CameraModel& camera, const YamlValue& place, const std::string& model,
                    const std::vector<double>& coefficients) {
  const auto found = lens_named(model);
  if (!found) {
    std::vector<std::string_view> names;
    names.reserve(kDistortionModels.size());
    for (const DistortionModel known : kDistortionModels) names.push_back(lens_traits(known).name());
    place.fail("the distortion model '" + model + "' is not supported, only " + listed(names) + " are");
  }
  camera.distortion = DistortionModel::kNone;
  camera.coefficients.fill(0);
  if (*found == DistortionModel::kRadTan) return set_radtan(camera, place, coefficients);
  if (!lens_traits(*found).terms.empty()) return set_exactly(camera, place, *found, coefficients);
  if (std::ranges::any_of(coefficients, [](double k) { return k != 0; }))
    place.fail("the distortion model '" + model + "' has no coefficients");
  camera.distortion = *found;
}

void set_lens(CameraModel& camera, DistortionModel model, const std::vector<double>& coefficients) {
  camera.distortion = model;
  camera.coefficients.fill(0);
  std::copy(coefficients.begin(), coefficients.end(), camera.coefficients.begin());
  const double scale = focal_in_files(camera);
  camera.fx /= scale;
  camera.fy /= scale;
}

void set_eucm(CameraModel& camera, const YamlValue& place, double alpha, double beta) {
  if (!(alpha >= 0 && alpha <= 1 && beta > 0)) place.fail("alpha from 0 to 1 and beta above 0 are expected");
  set_fit(camera, place, "eucm", extended_unified_lens(alpha, beta));
}

std::string listed(const std::vector<std::string_view>& names) {
  std::string out;
  for (std::size_t i = 0; i < names.size(); ++i) {
    out += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + std::string(names[i]);
  }
  return out;
}

}  // namespace coslam::calibration
