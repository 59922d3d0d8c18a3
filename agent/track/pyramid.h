// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace coslam {

// One level: pixel (x, y) of it lies at (x * 2^level, y * 2^level) of the image. A margin of repeated border pixels
// surrounds it, so that a window may hang over the edge.
class PyramidLevel {
 public:
  static constexpr int kMargin = 32;

  int cols() const { return image_.cols; }
  int rows() const { return image_.rows; }
  std::ptrdiff_t stride() const { return static_cast<std::ptrdiff_t>(padded_.step[0]); }
  // Valid kMargin pixels beyond the image on every side.
  const std::uint8_t* at(int x, int y) const { return image_.data + y * stride() + x; }
  const cv::Mat& image() const { return image_; }
  // Start of the level's memory, margin included.
  const std::uint8_t* first_byte() const { return at(-kMargin, -kMargin); }
  std::size_t bytes() const { return static_cast<std::size_t>(stride() * (rows() + 2 * kMargin)); }

 private:
  friend class Pyramid;
  void resize(int cols, int rows);
  void fill_margin();

  cv::Mat padded_;
  cv::Mat image_;  // the part of padded_ inside the margin
};

// How many levels an image has room for, `most` at most.
int pyramid_levels(int cols, int rows, int most);

// Image pyramid by Gaussian halving. Buffers are kept from image to image. Thread-compatible.
class Pyramid {
 public:
  // Builds the pyramid, with fewer levels where the image is too small for them. `grey` is CV_8UC1.
  void build(const cv::Mat& grey, int levels);
  int levels() const { return static_cast<int>(levels_.size()); }
  const PyramidLevel& level(int i) const { return levels_[static_cast<std::size_t>(i)]; }
  bool empty() const { return levels_.empty(); }

 private:
  std::vector<PyramidLevel> levels_;
};

}  // namespace coslam
