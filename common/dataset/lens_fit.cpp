// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/dataset/lens_fit.h"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace coslam {
double farthest_corner(const CameraModel& c) {
  const double x = std::max(c.cx + 0.5, c.width_px - 0.5 - c.cx) / c.fx;
  const double y = std::max(c.cy + 0.5, c.height_px - 0.5 - c.cy) / c.fy;
  return std::hypot(x, y);
}

RadiusOfAngle field_of_view_lens(double w_rad) {
  return [w_rad](double angle) {
    if (std::abs(w_rad) < 1e-6) return std::tan(angle);
    return std::atan(2 * std::tan(angle) * std::tan(0.5 * w_rad)) / w_rad;
  };
}

RadiusOfAngle extended_unified_lens(double alpha, double beta) {
  return [alpha, beta](double angle) {
    const double s = std::sin(angle), c = std::cos(angle);
    return s / (alpha * std::sqrt(beta * s * s + c * c) + (1 - alpha) * c);
  };
}

FittedLens fit_equidistant(const CameraModel& camera, const RadiusOfAngle& radius) {
  constexpr int kSamples = 400, kTerms = 5;
  constexpr double kWidest_rad = 0.5 * std::numbers::pi - 0.02;  // beyond there is no image plane
  const double corner = farthest_corner(camera);
  double end = 0;
  while (end < kWidest_rad && radius(end) < corner) end += kWidest_rad / 1000;
  Eigen::Matrix<double, kSamples, kTerms> powers;
  Eigen::Matrix<double, kSamples, 1> radii;
  for (int i = 0; i < kSamples; ++i) {
    const double angle = end * (i + 1) / kSamples;
    for (int j = 0; j < kTerms; ++j) powers(i, j) = std::pow(angle, 2 * j + 1);
    radii[i] = radius(angle);
  }
  const Eigen::Matrix<double, kTerms, 1> terms = powers.colPivHouseholderQr().solve(radii);
  FittedLens out{camera};
  out.camera.distortion = DistortionModel::kEquidistant;
  out.camera.fx *= terms[0];
  out.camera.fy *= terms[0];
  out.camera.coefficients.fill(0);
  for (int j = 1; j < kTerms; ++j) out.camera.coefficients[static_cast<std::size_t>(j - 1)] = terms[j] / terms[0];
  out.miss_px = (powers * terms - radii).cwiseAbs().maxCoeff() * std::max(camera.fx, camera.fy);
  return out;
}

std::string fit_said(const std::string& model, const FittedLens& fit) {
  std::array<char, 32> miss{};
  std::snprintf(miss.data(), miss.size(), "%.2g", fit.miss_px);
  return "the lens '" + model + "' is taken as the nearest equidistant one, which is " + miss.data() +
         " pixels off at most";
}

}  // namespace coslam
