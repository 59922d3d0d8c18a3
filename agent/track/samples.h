// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

// The 16 x 16 samples of a window: 16-bit integers, which every processor's vector unit does well, and which give the
// same bits on all of them.
namespace coslam {

constexpr int kWindowSide = 16;
constexpr int kWindowArea = kWindowSide * kWindowSide;
// The window's pixels lie at centre - 7.5 ... centre + 7.5 in x and y.
constexpr float kWindowHalf_px = 0.5f * (kWindowSide - 1);

// Samples of an image carry 5 bits below a grey level and are centred, so that they lie within +-4096; values of a
// template carry 3. By Cauchy and Schwarz a sum of products over a window then stays below 256 * 4096 * 1024 = 2^30.
constexpr int kSampleUnit = 32;
constexpr int kSampleCentre = 128 * kSampleUnit;
constexpr int kWeightSum = 256;  // sum of the four bilinear weights: 255 * 256 just fits 16 bits
constexpr int kWeightShift = 3;  // kWeightSum / kSampleUnit = 2^3
constexpr int kTemplateShift = 2;
constexpr int kTemplateUnit = kSampleUnit >> kTemplateShift;

struct alignas(64) Samples : std::array<std::int16_t, kWindowArea> {};

// A sum of products with the means taken out.
inline double centred(int products, int total_a, int total_b) {
  return products - static_cast<double>(total_a) * total_b / kWindowArea;
}

}  // namespace coslam
