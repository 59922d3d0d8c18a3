// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/window.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace coslam {
namespace {

// Of the window whose first sample is there.
FirstSample first_sample(const PyramidLevel& level, float x, float y) {
  // Rounds down without a call: truncation does for what is above -kMargin.
  constexpr int kMargin = PyramidLevel::kMargin;
  const int ix = static_cast<int>(x + kMargin) - kMargin, iy = static_cast<int>(y + kMargin) - kMargin;
  const float a = x - static_cast<float>(ix), b = y - static_cast<float>(iy);
  const auto weight = [](float w) { return static_cast<int>(w * kWeightSum + 0.5f); };
  const int w01 = weight(a * (1 - b)), w10 = weight((1 - a) * b);
  const int w11 = std::min(weight(a * b), kWeightSum - w01 - w10);  // rounding must not make the fourth negative
  return {level.at(ix, iy),
          level.stride(),
          static_cast<std::uint16_t>(kWeightSum - w01 - w10 - w11),
          static_cast<std::uint16_t>(w01),
          static_cast<std::uint16_t>(w10),
          static_cast<std::uint16_t>(w11)};
}

FirstSample first_of_window(const PyramidLevel& level, const Eigen::Vector2f& centre_px) {
  return first_sample(level, centre_px.x() - kWindowHalf_px, centre_px.y() - kWindowHalf_px);
}

void prepare(const TemplateSums& sums, WindowTemplate& w) {
  w.total_dx = sums.dx;
  w.total_dy = sums.dy;
  w.total_grey = sums.grey;
  Eigen::Matrix3d products;
  products(0, 0) = centred(sums.dx_dx, sums.dx, sums.dx);
  products(1, 1) = centred(sums.dy_dy, sums.dy, sums.dy);
  products(2, 2) = w.squares = centred(sums.grey_grey, sums.grey, sums.grey);
  products(0, 1) = products(1, 0) = centred(sums.dx_dy, sums.dx, sums.dy);
  products(0, 2) = products(2, 0) = centred(sums.dx_grey, sums.dx, sums.grey);
  products(1, 2) = products(2, 1) = centred(sums.dy_grey, sums.dy, sums.grey);
  w.min_eigenvalue = 0;
  if (w.squares <= 0) return;
  const Eigen::Vector2d g = products.topRightCorner<2, 1>();
  const Eigen::Matrix2d tensor = products.topLeftCorner<2, 2>() - g * g.transpose() / w.squares;
  const double spread =
      std::sqrt(0.25 * (tensor(0, 0) - tensor(1, 1)) * (tensor(0, 0) - tensor(1, 1)) + tensor(0, 1) * tensor(0, 1));
  w.min_eigenvalue = (0.5 * tensor.trace() - spread) / (kTemplateUnit * kTemplateUnit);
  if (w.min_eigenvalue > 0) w.inverse = products.inverse();
}

}  // namespace

bool window_readable(const PyramidLevel& level, const Eigen::Vector2f& centre_px) {
  return centre_px.x() >= -kWindowReach_px && centre_px.y() >= -kWindowReach_px &&
         centre_px.x() <= static_cast<float>(level.cols() - 1) + kWindowReach_px &&
         centre_px.y() <= static_cast<float>(level.rows() - 1) + kWindowReach_px;
}

void cut_template(const PyramidLevel& level, const Eigen::Vector2f& centre_px, WindowTemplate& window) {
  const FirstSample first = first_sample(level, centre_px.x() - kWindowHalf_px - 1, centre_px.y() - kWindowHalf_px - 1);
  prepare(kernels().cut(first, window.grey.data(), window.dx.data(), window.dy.data()), window);
}

WindowStep window_step(const PyramidLevel& level, const Eigen::Vector2f& centre_px, const WindowTemplate& window) {
  const StepSums sums =
      kernels().step(first_of_window(level, centre_px), window.grey.data(), window.dx.data(), window.dy.data());
  const Eigen::Vector3d products(centred(sums.dx, sums.total, window.total_dx),
                                 centred(sums.dy, sums.total, window.total_dy),
                                 centred(sums.grey, sums.total, window.total_grey));
  const Eigen::Vector3d solution = window.inverse * products;  // gain * offset, gain
  WindowStep step;
  step.gain = static_cast<float>(solution.z() * kTemplateUnit / kSampleUnit);
  if (step.gain > 0) step.offset_px = (solution.head<2>() / solution.z()).cast<float>();
  return step;
}

float window_zncc(const PyramidLevel& level, const Eigen::Vector2f& centre_px, const WindowTemplate& window) {
  const CorrelationSums sums = kernels().correlate(first_of_window(level, centre_px), window.grey.data());
  const double squares = centred(sums.small_squares, sums.small_total, sums.small_total);
  if (squares <= 0 || window.squares <= 0) return 0.0f;
  const double product = centred(sums.grey, sums.total, window.total_grey);
  return static_cast<float>(product / ((1 << kTemplateShift) * std::sqrt(squares * window.squares)));
}

}  // namespace coslam
