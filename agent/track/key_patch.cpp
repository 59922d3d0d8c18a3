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

constexpr int kFixedOne = 1 << kFixedShift;

int fixed(float value) { return static_cast<int>(std::lround(value * static_cast<float>(kFixedOne))); }

bool readable(const PyramidLevel& level, const Eigen::Vector2f& centre, const Eigen::Matrix2f& warp) {
  const Eigen::Vector2f reach = warp.cwiseAbs() * Eigen::Vector2f(kWindowHalf_px, kWindowHalf_px);
  constexpr float kMargin = PyramidLevel::kMargin - 2;
  return centre.x() - reach.x() >= -kMargin && centre.y() - reach.y() >= -kMargin &&
         centre.x() + reach.x() <= static_cast<float>(level.cols() - 1) + kMargin &&
         centre.y() + reach.y() <= static_cast<float>(level.rows() - 1) + kMargin;
}

WarpedSample first_warped(const PyramidLevel& level, const Eigen::Vector2f& centre, const Eigen::Matrix2f& warp) {
  const Eigen::Vector2f first = centre - warp * Eigen::Vector2f(kWindowHalf_px, kWindowHalf_px);
  return {.origin = level.at(0, 0),
          .stride = level.stride(),
          .x = fixed(first.x()),
          .y = fixed(first.y()),
          .x_u = fixed(warp(0, 0)),
          .y_u = fixed(warp(1, 0)),
          .x_v = fixed(warp(0, 1)),
          .y_v = fixed(warp(1, 1))};
}

constexpr float kMomentUnit = 8.0f;  // of WarpedSums

// Products of the samples, mean taken out, with the derivatives of the patch by all parameters.
Vector7f project(const KeyPatch& patch, const WarpedSums& sums) {
  Vector7f moments;
  moments << static_cast<float>(sums.dx), static_cast<float>(sums.dy), kMomentUnit * static_cast<float>(sums.column_dx),
      kMomentUnit * static_cast<float>(sums.row_dx), kMomentUnit * static_cast<float>(sums.column_dy),
      kMomentUnit * static_cast<float>(sums.row_dy), static_cast<float>(sums.grey);
  return moments - patch.totals * (static_cast<float>(sums.total) / kWindowArea);
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
    const WarpedSums sums =
        kernels().warped(first_warped(level, at, warp), patch.grey.data(), patch.dx.data(), patch.dy.data());
    const Vector7f moments = project(patch, sums);
    const float own_squares = static_cast<float>(centred(sums.small_squares, sums.small_total, sums.small_total));
    result.zncc =
        own_squares > 0 ? moments[6] / ((1 << kTemplateShift) * std::sqrt(own_squares * patch.squares)) : 0.0f;
    const Vector7f solution = patch.inverse * moments;
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
