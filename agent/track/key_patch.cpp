// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/key_patch.h"

#include <Eigen/LU>
#include <cmath>

#include "agent/track/match_limits.h"
#include "agent/track/window.h"

namespace coslam {
namespace {

using Vector7f = KeyPatch::Vector7f;

// Expected change of the warp from image to image, and of grey values that the model does not explain.
constexpr float kWarpSigma = 0.02f;
constexpr float kGreySigma = 4.0f * kTemplateUnit;

constexpr int kFixedShift = 16;  // coordinates of the warped samples, 16 bits below a pixel
constexpr int kFixedOne = 1 << kFixedShift;

int fixed(float value) { return static_cast<int>(std::lround(value * static_cast<float>(kFixedOne))); }

bool readable(const PyramidLevel& level, const Eigen::Vector2f& centre, const Eigen::Matrix2f& warp) {
  const Eigen::Vector2f reach = warp.cwiseAbs() * Eigen::Vector2f(kWindowHalf_px, kWindowHalf_px);
  constexpr float kMargin = PyramidLevel::kMargin - 2;
  return centre.x() - reach.x() >= -kMargin && centre.y() - reach.y() >= -kMargin &&
         centre.x() + reach.x() <= static_cast<float>(level.cols() - 1) + kMargin &&
         centre.y() + reach.y() <= static_cast<float>(level.rows() - 1) + kMargin;
}

void sample_warped(const PyramidLevel& level, const Eigen::Vector2f& centre, const Eigen::Matrix2f& warp,
                   Samples& out) {
  const Eigen::Vector2f first = centre - warp * Eigen::Vector2f(kWindowHalf_px, kWindowHalf_px);
  const int x_u = fixed(warp(0, 0)), y_u = fixed(warp(1, 0)), x_v = fixed(warp(0, 1)), y_v = fixed(warp(1, 1));
  int x_row = fixed(first.x()), y_row = fixed(first.y());
  const std::uint8_t* origin = level.at(0, 0);
  const std::ptrdiff_t stride = level.stride();
  std::int16_t* sample = out.data();
  for (int r = 0; r < kWindowSide; ++r, x_row += x_v, y_row += y_v) {
    int x = x_row, y = y_row;
    for (int c = 0; c < kWindowSide; ++c, x += x_u, y += y_u) {
      const std::uint8_t* p = origin + (y >> kFixedShift) * stride + (x >> kFixedShift);
      const int a = (x >> 8) & 255, b = (y >> 8) & 255;  // fractions in 8 bits, so the value has 16 below a grey level
      const int upper = (p[0] << 8) + (p[1] - p[0]) * a;
      const int lower = (p[stride] << 8) + (p[stride + 1] - p[stride]) * a;
      *sample++ = static_cast<std::int16_t>((((upper << 8) + (lower - upper) * b) >> 11) - kSampleCentre);
    }
  }
}

// Samples times their column, or row, from the window's centre, in eighths.
constexpr float kMomentUnit = 8.0f;

Samples times_column(const Samples& samples) {
  Samples out;
  for (int i = 0; i < kWindowArea; ++i) {
    const auto k = static_cast<std::size_t>(i);
    out[k] = static_cast<std::int16_t>((samples[k] * (2 * (i % kWindowSide) - (kWindowSide - 1)) + 8) >> 4);
  }
  return out;
}

Samples times_row(const Samples& samples) {
  Samples out;
  for (int i = 0; i < kWindowArea; ++i) {
    const auto k = static_cast<std::size_t>(i);
    out[k] = static_cast<std::int16_t>((samples[k] * (2 * (i / kWindowSide) - (kWindowSide - 1)) + 8) >> 4);
  }
  return out;
}

// Products of the samples, mean taken out, with the derivatives of the patch by all parameters.
Vector7f project(const KeyPatch& patch, const Samples& samples) {
  const Samples by_column = times_column(samples), by_row = times_row(samples);
  Vector7f sums;
  sums << static_cast<float>(dot(samples, patch.dx)), static_cast<float>(dot(samples, patch.dy)),
      kMomentUnit * static_cast<float>(dot(by_column, patch.dx)),
      kMomentUnit * static_cast<float>(dot(by_row, patch.dx)),
      kMomentUnit * static_cast<float>(dot(by_column, patch.dy)),
      kMomentUnit * static_cast<float>(dot(by_row, patch.dy)), static_cast<float>(dot(samples, patch.grey));
  return sums - patch.totals * (static_cast<float>(total(samples)) / kWindowArea);
}

}  // namespace

void KeyPatch::take(const PyramidLevel& level, const Eigen::Vector2f& centre_px) {
  WindowTemplate window;
  cut_template(level, centre_px, window);
  grey = window.grey;
  dx = window.dx;
  dy = window.dy;
  squares = static_cast<float>(window.squares);
  warp.setIdentity();
  Eigen::Matrix<float, kWindowArea, 7> derivatives;
  for (int i = 0; i < kWindowArea; ++i) {
    const float u = static_cast<float>(i % kWindowSide) - kWindowHalf_px;
    const float v = static_cast<float>(i / kWindowSide) - kWindowHalf_px;
    const auto k = static_cast<std::size_t>(i);
    const float gx = dx[k], gy = dy[k];
    derivatives.row(i) << gx, gy, gx * u, gx * v, gy * u, gy * v, grey[k];
  }
  totals = derivatives.colwise().sum();
  derivatives.rowwise() -= totals.transpose() / kWindowArea;
  Eigen::Matrix<float, 7, 7> normal = derivatives.transpose() * derivatives;
  constexpr float kDamping = (kGreySigma / kWarpSigma) * (kGreySigma / kWarpSigma);
  normal.diagonal().segment<4>(2).array() += kDamping;
  inverse = normal.cast<double>().inverse().cast<float>();
}

KeyAlignment find_key_patch(const KeyPatch& patch, const Pyramid& pyramid, const Eigen::Vector2f& guess_px) {
  KeyAlignment result;
  int level_index = 0;
  float scale = 1.0f;  // pixels of level 0 a pixel of the level
  while (patch.warp.determinant() > kWidestScale * kWidestScale * scale * scale && level_index + 1 < pyramid.levels()) {
    ++level_index;
    scale *= 2;
  }
  const PyramidLevel& level = pyramid.level(level_index);
  const Eigen::Vector2f start = guess_px / scale;
  Eigen::Vector2f at = start;
  Eigen::Matrix2f warp = patch.warp / scale;
  for (int i = 0; i < kKeyIterations; ++i) {
    if (!readable(level, at, warp)) return result;
    Samples samples;
    sample_warped(level, at, warp, samples);
    const Vector7f with = project(patch, samples);
    const float own_squares = static_cast<float>(centred_squares(samples));
    result.zncc = own_squares > 0 ? with[6] / ((1 << kTemplateShift) * std::sqrt(own_squares * patch.squares)) : 0.0f;
    const Vector7f solution = patch.inverse * with;
    if (!(solution[6] * kTemplateUnit > kKeyLeastGain * kSampleUnit)) return result;
    const Vector7f change = solution / solution[6];
    Eigen::Matrix2f affine;  // of the patch, as now seen; to be undone
    affine << 1 + change[2], change[3], change[4], 1 + change[5];
    if (!(affine.determinant() > kLeastDeterminant)) return result;
    warp = warp * affine.inverse();
    const Eigen::Vector2f step = warp * change.head<2>();
    at -= step;
    if (!((at - start).squaredNorm() < kKeyFurthest_px * kKeyFurthest_px)) return result;
    if (step.squaredNorm() < kKeyConverged_px * kKeyConverged_px) break;
  }
  result.found = true;
  result.px = at * scale;
  result.warp = warp * scale;
  return result;
}

}  // namespace coslam
