// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/corner_score.h"

#include <algorithm>
#include <cmath>

namespace coslam {
namespace {

constexpr int kWindow = 5;
constexpr int kHalf = kWindow / 2;
constexpr float kSobelGain = 8.0f;  // of the 3 x 3 Sobel kernel on a ramp of one grey level a pixel

}  // namespace

// The newest row of products replaces the oldest in the ring and in the column sums.
void CornerScore::add_row(const PyramidLevel& image, int x0, int y, int slot) {
  const std::uint8_t* p = image.at(x0 - kHalf, y);
  const std::uint8_t* up = p - image.stride();
  const std::uint8_t* down = p + image.stride();
  int* xx = products_.data() + slot * 3 * width_;
  int* xy = xx + width_;
  int* yy = xy + width_;
  int* sum_xx = columns_.data();
  int* sum_xy = sum_xx + width_;
  int* sum_yy = sum_xy + width_;
  for (int i = 0; i < width_; ++i) {
    const int gx = (up[i + 1] - up[i - 1]) + 2 * (p[i + 1] - p[i - 1]) + (down[i + 1] - down[i - 1]);
    const int gy = (down[i - 1] - up[i - 1]) + 2 * (down[i] - up[i]) + (down[i + 1] - up[i + 1]);
    sum_xx[i] += gx * gx - xx[i];
    sum_xy[i] += gx * gy - xy[i];
    sum_yy[i] += gy * gy - yy[i];
    xx[i] = gx * gx;
    xy[i] = gx * gy;
    yy[i] = gy * gy;
  }
}

void CornerScore::score_row(float* out) const {
  const int* xx = columns_.data();
  const int* xy = xx + width_;
  const int* yy = xy + width_;
  constexpr float kScale = 1.0f / (kSobelGain * kSobelGain * kWindow * kWindow);
  for (int i = 0; i < cols_; ++i) {
    int sum_xx = 0, sum_xy = 0, sum_yy = 0;
    for (int k = 0; k < kWindow; ++k) {
      sum_xx += xx[i + k];
      sum_xy += xy[i + k];
      sum_yy += yy[i + k];
    }
    const float a = static_cast<float>(sum_xx), b = static_cast<float>(sum_xy), c = static_cast<float>(sum_yy);
    const float half = 0.5f * (a - c);
    out[i] = kScale * (0.5f * (a + c) - std::sqrt(half * half + b * b));
  }
}

void CornerScore::compute(const PyramidLevel& image, int x0, int y0, int cols, int rows) {
  cols_ = cols;
  rows_ = rows;
  width_ = cols + 2 * kHalf;
  const auto row_size = static_cast<std::size_t>(3 * width_);
  products_.assign(row_size * kWindow, 0);
  columns_.assign(row_size, 0);
  scores_.resize(static_cast<std::size_t>(cols) * static_cast<std::size_t>(rows));
  for (int y = 0; y < rows + 2 * kHalf; ++y) {
    add_row(image, x0, y0 - kHalf + y, y % kWindow);
    if (y >= 2 * kHalf) score_row(scores_.data() + (y - 2 * kHalf) * cols);
  }
}

}  // namespace coslam
