// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "agent/track/pyramid.h"

namespace coslam {

constexpr int kCornerHalf = 3;  // half the width of the window
// Products are stored this many bits smaller, so that the weighted sums fit: (4 * 255)^2 / 4 * 64 * 64 < 2^31.
constexpr int kProductShift = 2;
constexpr float kWindowWeight = 64.0F * 64.0F;  // binomial weights 1 6 15 20 15 6 1, down and across
constexpr float kSobelGain = 8.0F;  // response of the 3 x 3 Sobel kernel to a ramp of one grey level a pixel
constexpr float kScoreScale = (1 << kProductShift) / (kSobelGain * kSobelGain * kWindowWeight);

// Smaller eigenvalue of the structure tensor, in (grey levels / pixel)^2, for a part of an image. The tensor is
// averaged under a bell of 7 x 7 pixels: a box would make plateaus of ideal corners. Buffers are kept from call to
// call.
class CornerScore {
 public:
  // Computes the scores of the pixels [x0, x0 + cols) x [y0, y0 + rows), which may hang a little over the image into
  // its margin.
  void compute(const PyramidLevel& image, int x0, int y0, int cols, int rows);

  int cols() const { return cols_; }
  int rows() const { return rows_; }
  const float* row(int y) const { return scores_.data() + y * cols_; }

 private:
  void differentiate_row(const PyramidLevel& image, int x0, int y, int* xx);
  void sum_columns(int y);
  void score_row(float* out) const;

  int cols_ = 0, rows_ = 0;
  int width_ = 0;              // length of a row of products: cols_ and the margin of the window
  std::vector<int> products_;  // rows, each gx gx, gx gy, gy gy
  std::vector<int> columns_;   // weighted sums down the window, laid out like one row of them
  std::vector<float> scores_;
};

}  // namespace coslam
