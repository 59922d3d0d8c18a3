// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/corner_score.h"

#include <cmath>

namespace coslam {
namespace {

inline int binomial(int a, int b, int c, int d, int e, int f, int g) {
  return (a + g) + 6 * (b + f) + 15 * (c + e) + 20 * d;
}

}  // namespace

void CornerScore::differentiate_row(const PyramidLevel& image, int x0, int y, int* xx) {
  const std::uint8_t* p = image.at(x0 - kCornerHalf, y);
  const std::uint8_t* up = p - image.stride();
  const std::uint8_t* down = p + image.stride();
  int* xy = xx + width_;
  int* yy = xy + width_;
  for (int i = 0; i < width_; ++i) {
    const int gx = (up[i + 1] - up[i - 1]) + 2 * (p[i + 1] - p[i - 1]) + (down[i + 1] - down[i - 1]);
    const int gy = (down[i - 1] - up[i - 1]) + 2 * (down[i] - up[i]) + (down[i + 1] - up[i + 1]);
    xx[i] = (gx * gx) >> kProductShift;
    xy[i] = (gx * gy) >> kProductShift;
    yy[i] = (gy * gy) >> kProductShift;
  }
}

void CornerScore::sum_columns(int y) {
  const int row_size = 3 * width_;
  const int* r = products_.data() + y * row_size;
  int* out = columns_.data();
  for (int i = 0; i < row_size; ++i) {
    out[i] = binomial(r[i], r[i + row_size], r[i + 2 * row_size], r[i + 3 * row_size], r[i + 4 * row_size],
                      r[i + 5 * row_size], r[i + 6 * row_size]);
  }
}

void CornerScore::score_row(float* out) const {
  const int* xx = columns_.data();
  const int* xy = xx + width_;
  const int* yy = xy + width_;
  const auto across = [](const int* p) {
    return static_cast<float>(binomial(p[0], p[1], p[2], p[3], p[4], p[5], p[6]));
  };
  for (int i = 0; i < cols_; ++i) {
    const float a = across(xx + i), b = across(xy + i), c = across(yy + i);
    const float half = 0.5F * (a - c);
    out[i] = kScoreScale * (0.5F * (a + c) - std::sqrt(half * half + b * b));
  }
}

void CornerScore::compute(const PyramidLevel& image, int x0, int y0, int cols, int rows) {
  cols_ = cols;
  rows_ = rows;
  width_ = cols + 2 * kCornerHalf;
  const int row_size = 3 * width_;
  products_.resize(static_cast<std::size_t>(row_size * (rows + 2 * kCornerHalf)));
  columns_.resize(static_cast<std::size_t>(row_size));
  scores_.resize(static_cast<std::size_t>(cols * rows));
  for (int y = 0; y < rows + 2 * kCornerHalf; ++y) {
    differentiate_row(image, x0, y0 - kCornerHalf + y, products_.data() + y * row_size);
  }
  for (int y = 0; y < rows; ++y) {
    sum_columns(y);
    score_row(scores_.data() + y * cols);
  }
}

}  // namespace coslam
