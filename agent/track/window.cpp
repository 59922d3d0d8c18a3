// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/window.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace coslam {
namespace {

// Samples carry 5 bits below a grey level and are centred, so that they lie within +-4096; template values carry 3
// bits. By Cauchy and Schwarz any sum of products over the window then stays below 256 * 4096 * 1024 = 2^30.
constexpr int kSampleUnit = 32;
constexpr int kSampleCentre = 128 * kSampleUnit;
constexpr int kTemplateShift = 2;
constexpr double kTemplateUnit = kSampleUnit >> kTemplateShift;
constexpr int kWeightSum = 256;  // of the four bilinear weights: 255 * 256 just fits 16 bits
constexpr int kWeightShift = 3;  // kWeightSum / kSampleUnit = 2^3

// Whole pixel and bilinear weights of a window's first sample.
struct Corner16 {
  const std::uint8_t* first;
  std::uint16_t w00, w01, w10, w11;
};

Corner16 corner_of(const PyramidLevel& level, float x, float y) {
  const int ix = static_cast<int>(std::floor(x)), iy = static_cast<int>(std::floor(y));
  const float a = x - static_cast<float>(ix), b = y - static_cast<float>(iy);
  const auto weight = [](float w) { return static_cast<int>(w * kWeightSum + 0.5f); };
  const int w01 = weight(a * (1 - b)), w10 = weight((1 - a) * b);
  const int w11 = std::min(weight(a * b), kWeightSum - w01 - w10);  // rounding must not make the fourth negative
  return {level.at(ix, iy), static_cast<std::uint16_t>(kWeightSum - w01 - w10 - w11), static_cast<std::uint16_t>(w01),
          static_cast<std::uint16_t>(w10), static_cast<std::uint16_t>(w11)};
}

template <int kCols, int kRows>
inline void sample(const Corner16& corner, std::ptrdiff_t stride, std::int16_t* out) {
  const std::uint16_t w00 = corner.w00, w01 = corner.w01, w10 = corner.w10, w11 = corner.w11;
  const std::uint8_t* upper = corner.first;
  for (int r = 0; r < kRows; ++r, upper += stride, out += kCols) {
    const std::uint8_t* lower = upper + stride;
    for (int c = 0; c < kCols; ++c) {
      const auto sum =
          static_cast<std::uint16_t>(upper[c] * w00 + upper[c + 1] * w01 + lower[c] * w10 + lower[c + 1] * w11);
      out[c] = static_cast<std::int16_t>((sum >> kWeightShift) - kSampleCentre);
    }
  }
}

using Samples = std::array<std::int16_t, kWindowArea>;

inline int dot(const Samples& a, const Samples& b) {
  int sum = 0;
  for (int i = 0; i < kWindowArea; ++i) sum += a[static_cast<std::size_t>(i)] * b[static_cast<std::size_t>(i)];
  return sum;
}

inline int total(const Samples& a) {
  int sum = 0;
  for (int i = 0; i < kWindowArea; ++i) sum += a[static_cast<std::size_t>(i)];
  return sum;
}

double centred(int products, int sum_a, int sum_b) {
  return static_cast<double>(products) - static_cast<double>(sum_a) * sum_b / kWindowArea;
}

void sample_window(const PyramidLevel& level, const Eigen::Vector2f& centre_px, Samples& out) {
  const Corner16 corner = corner_of(level, centre_px.x() - kWindowHalf_px, centre_px.y() - kWindowHalf_px);
  sample<kWindowSide, kWindowSide>(corner, level.stride(), out.data());
}

}  // namespace

bool window_readable(const PyramidLevel& level, const Eigen::Vector2f& centre_px) {
  // Half a window, a pixel for the derivative and up to 7 more that the wide loads of cut_template() touch.
  constexpr float kReach = PyramidLevel::kMargin - kWindowHalf_px - 9;
  return centre_px.x() >= -kReach && centre_px.y() >= -kReach &&
         centre_px.x() <= static_cast<float>(level.cols() - 1) + kReach &&
         centre_px.y() <= static_cast<float>(level.rows() - 1) + kReach;
}

void WindowTemplate::prepare() {
  sums = {total(dx), total(dy), total(grey)};
  products(0, 0) = centred(dot(dx, dx), sums[0], sums[0]);
  products(1, 1) = centred(dot(dy, dy), sums[1], sums[1]);
  products(2, 2) = centred(dot(grey, grey), sums[2], sums[2]);
  products(0, 1) = products(1, 0) = centred(dot(dx, dy), sums[0], sums[1]);
  products(0, 2) = products(2, 0) = centred(dot(dx, grey), sums[0], sums[2]);
  products(1, 2) = products(2, 1) = centred(dot(dy, grey), sums[1], sums[2]);
  min_eigenvalue = 0;
  const double greys = products(2, 2);
  if (greys <= 0) return;
  const Eigen::Vector2d g = products.topRightCorner<2, 1>();
  const Eigen::Matrix2d tensor = products.topLeftCorner<2, 2>() - g * g.transpose() / greys;
  const double mean = 0.5 * tensor.trace();
  const double spread = std::hypot(0.5 * (tensor(0, 0) - tensor(1, 1)), tensor(0, 1));
  min_eigenvalue = (mean - spread) / (kTemplateUnit * kTemplateUnit);
  if (min_eigenvalue > 0) inverse = products.inverse();
}

void cut_template(const PyramidLevel& level, const Eigen::Vector2f& centre_px, WindowTemplate& window) {
  constexpr int kCols = 24, kRows = kWindowSide + 2;  // a pixel more on every side, and columns up to whole vectors
  alignas(64) std::array<std::int16_t, kCols * kRows> samples;
  const Corner16 corner = corner_of(level, centre_px.x() - kWindowHalf_px - 1, centre_px.y() - kWindowHalf_px - 1);
  sample<kCols, kRows>(corner, level.stride(), samples.data());
  constexpr int kDoubled = 1;  // central differences over two pixels
  for (int r = 0; r < kWindowSide; ++r) {
    const std::int16_t* row = samples.data() + (r + 1) * kCols + 1;
    std::int16_t* grey = window.grey.data() + r * kWindowSide;
    std::int16_t* dx = window.dx.data() + r * kWindowSide;
    std::int16_t* dy = window.dy.data() + r * kWindowSide;
    for (int c = 0; c < kWindowSide; ++c) {
      grey[c] = static_cast<std::int16_t>(row[c] >> kTemplateShift);
      dx[c] = static_cast<std::int16_t>((row[c + 1] - row[c - 1]) >> (kTemplateShift + kDoubled));
      dy[c] = static_cast<std::int16_t>((row[c + kCols] - row[c - kCols]) >> (kTemplateShift + kDoubled));
    }
  }
  window.prepare();
}

WindowStep window_step(const PyramidLevel& level, const Eigen::Vector2f& centre_px, const WindowTemplate& window) {
  alignas(64) Samples samples;
  sample_window(level, centre_px, samples);
  const int sum = total(samples);
  const Eigen::Vector3d with(centred(dot(samples, window.dx), sum, window.sums[0]),
                             centred(dot(samples, window.dy), sum, window.sums[1]),
                             centred(dot(samples, window.grey), sum, window.sums[2]));
  const Eigen::Vector3d solution = window.inverse * with;  // gain * d, gain
  WindowStep step;
  step.gain = static_cast<float>(solution.z() * kTemplateUnit / kSampleUnit);
  step.d_px = (solution.head<2>() / solution.z()).cast<float>();
  return step;
}

float window_zncc(const PyramidLevel& level, const Eigen::Vector2f& centre_px, const WindowTemplate& window) {
  alignas(64) Samples samples;
  sample_window(level, centre_px, samples);
  const int sum = total(samples);
  const double with = centred(dot(samples, window.grey), sum, window.sums[2]);
  for (std::int16_t& s : samples) s = static_cast<std::int16_t>(s >> kTemplateShift);  // so that squares fit
  const int small_sum = total(samples);
  const double own = centred(dot(samples, samples), small_sum, small_sum);
  if (own <= 0 || window.products(2, 2) <= 0) return 0.0f;
  return static_cast<float>(with / (1 << kTemplateShift) / std::sqrt(own * window.products(2, 2)));
}

}  // namespace coslam
