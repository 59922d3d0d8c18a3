// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

// Sums over the 16 x 16 samples of a window, the inner loops of the tracker: 16-bit integers, which every processor's
// vector unit does well without special builds, and which give the same bits on all of them.
namespace coslam {

constexpr int kWindowSide = 16;
constexpr int kWindowArea = kWindowSide * kWindowSide;
// The window's pixels lie at centre - 7.5 ... centre + 7.5 in x and y.
constexpr float kWindowHalf_px = 0.5f * (kWindowSide - 1);

// Samples of an image carry 5 bits below a grey level and are centred, so that they lie within +-4096; values of a
// template carry 3. By Cauchy and Schwarz a sum of products over a window then stays below 256 * 4096 * 1024 = 2^30.
constexpr int kSampleUnit = 32;
constexpr int kSampleCentre = 128 * kSampleUnit;
constexpr int kWeightSum = 256;  // of the four bilinear weights: 255 * 256 just fits 16 bits
constexpr int kWeightShift = 3;  // kWeightSum / kSampleUnit = 2^3
constexpr int kTemplateShift = 2;
constexpr int kTemplateUnit = kSampleUnit >> kTemplateShift;

struct alignas(64) Samples : std::array<std::int16_t, kWindowArea> {};

inline int dot(const Samples& a, const Samples& b) {
  int sum = 0;
  for (std::size_t i = 0; i < kWindowArea; ++i) sum += a[i] * b[i];
  return sum;
}

inline int total(const Samples& a) {
  int sum = 0;
  for (std::size_t i = 0; i < kWindowArea; ++i) sum += a[i];
  return sum;
}

// A sum of products with the means taken out.
inline double centred(int products, int total_a, int total_b) {
  return products - static_cast<double>(total_a) * total_b / kWindowArea;
}

// Sum of squares with the mean taken out, in template units: image samples are too large for their squares to fit.
inline double centred_squares(const Samples& samples) {
  Samples small;
  for (std::size_t i = 0; i < kWindowArea; ++i) small[i] = static_cast<std::int16_t>(samples[i] >> kTemplateShift);
  const int sum = total(small);
  return centred(dot(small, small), sum, sum);
}

}  // namespace coslam
