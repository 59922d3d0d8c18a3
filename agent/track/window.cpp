// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/window.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace coslam {
namespace {

// Whole pixel and bilinear weights of the first sample; the others of a window share its fractions.
struct FirstSample {
  const std::uint8_t* pixel;
  std::uint16_t w00, w01, w10, w11;
};

FirstSample first_sample(const PyramidLevel& level, float x, float y) {
  // Rounds down without a call: truncation does for what is above -kMargin.
  constexpr int kMargin = PyramidLevel::kMargin;
  const int ix = static_cast<int>(x + kMargin) - kMargin, iy = static_cast<int>(y + kMargin) - kMargin;
  const float a = x - static_cast<float>(ix), b = y - static_cast<float>(iy);
  const auto weight = [](float w) { return static_cast<int>(w * kWeightSum + 0.5f); };
  const int w01 = weight(a * (1 - b)), w10 = weight((1 - a) * b);
  const int w11 = std::min(weight(a * b), kWeightSum - w01 - w10);  // rounding must not make the fourth negative
  return {level.at(ix, iy), static_cast<std::uint16_t>(kWeightSum - w01 - w10 - w11), static_cast<std::uint16_t>(w01),
          static_cast<std::uint16_t>(w10), static_cast<std::uint16_t>(w11)};
}

template <int kCols, int kRows>
inline void sample(const FirstSample& first, std::ptrdiff_t stride, std::int16_t* out) {
  const std::uint16_t w00 = first.w00, w01 = first.w01, w10 = first.w10, w11 = first.w11;
  const std::uint8_t* upper = first.pixel;
  for (int r = 0; r < kRows; ++r, upper += stride, out += kCols) {
    const std::uint8_t* lower = upper + stride;
    for (int c = 0; c < kCols; ++c) {
      const auto sum =
          static_cast<std::uint16_t>(upper[c] * w00 + upper[c + 1] * w01 + lower[c] * w10 + lower[c + 1] * w11);
      out[c] = static_cast<std::int16_t>((sum >> kWeightShift) - kSampleCentre);
    }
  }
}

// Central difference of samples, over two pixels, in template units.
inline std::int16_t difference(std::int16_t after, std::int16_t before) {
  const auto d = static_cast<std::int16_t>(after - before);  // fits: narrow before the shift, to stay in 16-bit lanes
  return static_cast<std::int16_t>(d >> (kTemplateShift + 1));
}

void sample_window(const PyramidLevel& level, const Eigen::Vector2f& centre_px, Samples& out) {
  const FirstSample first = first_sample(level, centre_px.x() - kWindowHalf_px, centre_px.y() - kWindowHalf_px);
  sample<kWindowSide, kWindowSide>(first, level.stride(), out.data());
}

void prepare(WindowTemplate& w) {
  w.total_dx = total(w.dx);
  w.total_dy = total(w.dy);
  w.total_grey = total(w.grey);
  Eigen::Matrix3d products;
  products(0, 0) = centred(dot(w.dx, w.dx), w.total_dx, w.total_dx);
  products(1, 1) = centred(dot(w.dy, w.dy), w.total_dy, w.total_dy);
  products(2, 2) = w.squares = centred(dot(w.grey, w.grey), w.total_grey, w.total_grey);
  products(0, 1) = products(1, 0) = centred(dot(w.dx, w.dy), w.total_dx, w.total_dy);
  products(0, 2) = products(2, 0) = centred(dot(w.dx, w.grey), w.total_dx, w.total_grey);
  products(1, 2) = products(2, 1) = centred(dot(w.dy, w.grey), w.total_dy, w.total_grey);
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
  // Written at once. NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init)
  alignas(64) std::array<std::int16_t, kTemplateCols * kTemplateRows> samples;
  const FirstSample first = first_sample(level, centre_px.x() - kWindowHalf_px - 1, centre_px.y() - kWindowHalf_px - 1);
  sample<kTemplateCols, kTemplateRows>(first, level.stride(), samples.data());
  for (int r = 0; r < kWindowSide; ++r) {
    const std::int16_t* row = samples.data() + (r + 1) * kTemplateCols + 1;
    std::int16_t* grey = window.grey.data() + r * kWindowSide;
    std::int16_t* dx = window.dx.data() + r * kWindowSide;
    std::int16_t* dy = window.dy.data() + r * kWindowSide;
    for (int c = 0; c < kWindowSide; ++c) {
      grey[c] = static_cast<std::int16_t>(row[c] >> kTemplateShift);
      dx[c] = difference(row[c + 1], row[c - 1]);
      dy[c] = difference(row[c + kTemplateCols], row[c - kTemplateCols]);
    }
  }
  prepare(window);
}

WindowStep window_step(const PyramidLevel& level, const Eigen::Vector2f& centre_px, const WindowTemplate& window) {
  Samples samples;
  sample_window(level, centre_px, samples);
  const int sum = total(samples);
  const Eigen::Vector3d with(centred(dot(samples, window.dx), sum, window.total_dx),
                             centred(dot(samples, window.dy), sum, window.total_dy),
                             centred(dot(samples, window.grey), sum, window.total_grey));
  const Eigen::Vector3d solution = window.inverse * with;  // gain * offset, gain
  WindowStep step;
  step.gain = static_cast<float>(solution.z() * kTemplateUnit / kSampleUnit);
  if (step.gain > 0) step.offset_px = (solution.head<2>() / solution.z()).cast<float>();
  return step;
}

float window_zncc(const PyramidLevel& level, const Eigen::Vector2f& centre_px, const WindowTemplate& window) {
  Samples samples;
  sample_window(level, centre_px, samples);
  const double squares = centred_squares(samples);
  if (squares <= 0 || window.squares <= 0) return 0.0f;
  const double with = centred(dot(samples, window.grey), total(samples), window.total_grey);
  return static_cast<float>(with / ((1 << kTemplateShift) * std::sqrt(squares * window.squares)));
}

}  // namespace coslam
