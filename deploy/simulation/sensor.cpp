// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/simulation/sensor.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <string_view>

#include "common/base/error.h"
#include "deploy/simulation/noise.h"

namespace coslam::sim {
namespace {

constexpr double kLensBlurPx = 0.6;
constexpr int kToneSteps = 1 << 14;
constexpr int kWidthPx = 640, kHeightPx = 480;

// Standard normal quantiles at equal steps of probability, read at a random place. Acklam's rational form is not
// needed: bisection on erfc is exact and runs once.
const std::array<float, 4096>& normal_quantiles() {
  static const std::array<float, 4096> table = [] {
    std::array<float, 4096> out{};
    for (std::size_t i = 0; i < out.size(); ++i) {
      const double p = (static_cast<double>(i) + 0.5) / static_cast<double>(out.size());
      double low = -5, high = 5;
      for (int k = 0; k < 40; ++k) {
        const double middle = 0.5 * (low + high);
        (0.5 * std::erfc(-middle / std::numbers::sqrt2) < p ? low : high) = middle;
      }
      out[i] = static_cast<float>(0.5 * (low + high));
    }
    return out;
  }();
  return table;
}

std::array<std::uint8_t, kToneSteps + 1> tone_curve(double gamma) {
  std::array<std::uint8_t, kToneSteps + 1> out{};
  for (int i = 0; i <= kToneSteps; ++i) {
    out[static_cast<std::size_t>(i)] =
        static_cast<std::uint8_t>(std::lround(255.0 * std::pow(static_cast<double>(i) / kToneSteps, 1.0 / gamma)));
  }
  return out;
}

CameraModel radtan_lens() {
  CameraModel c;
  c.fx = 462.4, c.fy = 461.1, c.cx = 322.6, c.cy = 237.8;
  c.distortion = DistortionModel::kRadTan;
  c.coefficients = lens_traits(c.distortion).typical;
  return c;
}

CameraModel second_radtan_lens() {
  CameraModel c;
  c.fx = 455.3, c.fy = 455.9, c.cx = 316.2, c.cy = 243.5;
  c.distortion = DistortionModel::kRadTan;
  c.coefficients = {-0.265, 0.062, -4e-4, 2.5e-4};
  return c;
}

CameraModel equidistant_lens() {
  CameraModel c;
  c.fx = 470.8, c.fy = 470.2, c.cx = 318.9, c.cy = 240.7;
  c.distortion = DistortionModel::kEquidistant;
  c.coefficients = lens_traits(c.distortion).typical;
  return c;
}

// So that the ray at half the field meets a corner of the image.
CameraModel wide_lens(CameraModel c, double field_deg) {
  c.cx = 0.5 * (kWidthPx - 1), c.cy = 0.5 * (kHeightPx - 1);
  const double edge = std::tan(0.5 * field_deg * std::numbers::pi / 180);
  c.fx = c.fy = 0.5 * std::hypot(kWidthPx, kHeightPx) / c.distort_normalized({edge, 0}).x();
  return c;
}

// A usual lens of this model: a fisheye has a field of 150 degrees, another one that of the first camera.
CameraModel typical_lens(DistortionModel model) {
  CameraModel c = radtan_lens();
  c.distortion = model;
  c.coefficients = lens_traits(model).typical;
  return lens_traits(model).fisheye ? wide_lens(c, 150) : c;
}

// Name of a lens model for those who ask for simulated cameras; empty: none has it.
std::string_view lens_name(DistortionModel model) {
  const LensTraits& lens = lens_traits(model);
  if (lens.guess) return {};
  return lens.terms.empty() ? "pinhole" : lens.name();
}

CameraModel lens_of(int index, const std::string& name) {
  constexpr std::string_view kFisheye = "fisheye";
  if (name.empty()) return std::array{radtan_lens, second_radtan_lens, equidistant_lens}[index % 3]();
  if (name == "equidistant") return equidistant_lens();
  for (const DistortionModel model : kDistortionModels) {
    if (name == lens_name(model)) return typical_lens(model);
  }
  if (name.starts_with(kFisheye)) {
    const char *from = name.data() + kFisheye.size(), *end = name.data() + name.size();
    int field_deg = 0;
    const auto [rest, error] = std::from_chars(from, end, field_deg);
    if (error == std::errc() && rest == end && field_deg >= 60 && field_deg <= 170) {
      return wide_lens(equidistant_lens(), field_deg);
    }
  }
  throw UserError("unknown lens '" + name + "' (known: " + known_lenses() + ", fisheye60 to fisheye170)");
}

double gain_at(const SensorModel& s, double t_s) {
  return s.gain * (1 + s.drift * std::sin(2 * std::numbers::pi * t_s / s.drift_period_s + s.drift_phase_rad));
}

}  // namespace

std::string known_lenses() {
  std::string out;
  for (const DistortionModel model : kDistortionModels) {
    const std::string_view name = lens_name(model);
    if (!name.empty()) out += (out.empty() ? "" : ", ") + std::string(name);
  }
  return out;
}

CameraModel simulated_camera(int index, double image_scale, const std::string& lens) {
  CameraModel c = lens_of(index, lens);
  c.width_px = static_cast<int>(std::lround(kWidthPx * image_scale));
  c.height_px = static_cast<int>(std::lround(kHeightPx * image_scale));
  c.fx *= image_scale;
  c.fy *= image_scale;
  // Pixel centres at whole numbers: the image starts at -0.5.
  c.cx = (c.cx + 0.5) * image_scale - 0.5;
  c.cy = (c.cy + 0.5) * image_scale - 0.5;
  return c;
}

SensorModel simulated_sensor(int index, std::uint64_t seed) {
  constexpr double kGains[3] = {1.0, 0.86, 1.12};
  SensorModel s;
  s.seed = mix(seed, static_cast<std::uint64_t>(index) + 1000);
  Random random(s.seed);
  s.gain = kGains[index % 3];
  s.drift_period_s = random.uniform(7, 11);
  s.drift_phase_rad = random.uniform(0, 2 * std::numbers::pi);
  return s;
}

cv::Mat1b expose(const cv::Mat1f& radiance, const SensorModel& s, int frame, double t_s) {
  cv::Mat1f soft;
  cv::GaussianBlur(radiance, soft, {5, 5}, kLensBlurPx);
  const auto curve = tone_curve(s.gamma);
  const auto& normal = normal_quantiles();
  const auto well = static_cast<float>(s.full_well_e), read = static_cast<float>(s.read_noise_e);
  const auto gain = static_cast<float>(gain_at(s, t_s)), loss = static_cast<float>(s.vignetting);
  const float cx = 0.5F * static_cast<float>(soft.cols), cy = 0.5F * static_cast<float>(soft.rows);
  const float corner = cx * cx + cy * cy;
  cv::Mat1b out(soft.size());
  std::uint64_t key = mix(s.seed, static_cast<std::uint64_t>(frame)), bits = 0;
  for (int y = 0; y < soft.rows; ++y) {
    const float dy = static_cast<float>(y) - cy;
    for (int x = 0; x < soft.cols; ++x) {
      bits = x % 4 == 0 ? mix(++key) : bits >> 16;
      const float dx = static_cast<float>(x) - cx;
      const float light = gain * soft(y, x) * (1 - loss * (dx * dx + dy * dy) / corner);
      const float electrons = std::clamp(light, 0.0F, 1.0F) * well;
      const float sigma = std::sqrt(electrons + read * read);
      const float value = (electrons + sigma * normal[bits & 4095U]) / well;
      out(y, x) = curve[static_cast<std::size_t>(std::clamp(value, 0.0F, 1.0F) * kToneSteps)];
    }
  }
  return out;
}

}  // namespace coslam::sim
