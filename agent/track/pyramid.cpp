// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/pyramid.h"

#include <algorithm>
#include <cstring>
#include <opencv2/imgproc.hpp>

namespace coslam {
namespace {

constexpr int kSmallestSide_px = 20;

}  // namespace

int pyramid_levels(int cols, int rows, int most) {
  int count = 1;
  while (count < most && (std::min(cols, rows) >> count) >= kSmallestSide_px) ++count;
  return count;
}

void PyramidLevel::resize(int cols, int rows) {
  if (cols == image_.cols && rows == image_.rows) return;
  // One row more than is ever used: kernels read a few pixels beyond the end of a row.
  padded_.create(rows + 2 * kMargin + 1, cols + 2 * kMargin, CV_8UC1);
  image_ = padded_(cv::Rect(kMargin, kMargin, cols, rows));
}

void PyramidLevel::fill_margin() {
  const std::size_t margin = kMargin, cols = static_cast<std::size_t>(image_.cols);
  for (int y = 0; y < image_.rows; ++y) {
    std::uint8_t* row = image_.ptr<std::uint8_t>(y);
    std::memset(row - margin, row[0], margin);
    std::memset(row + cols, row[cols - 1], margin);
  }
  const std::size_t width = static_cast<std::size_t>(padded_.cols);
  const int last = kMargin + image_.rows - 1;
  for (int i = 0; i < kMargin; ++i) {
    std::memcpy(padded_.ptr(i), padded_.ptr(kMargin), width);
    std::memcpy(padded_.ptr(last + 1 + i), padded_.ptr(last), width);
  }
}

void Pyramid::build(const cv::Mat& grey, int levels) {
  levels_.resize(static_cast<std::size_t>(pyramid_levels(grey.cols, grey.rows, levels)));
  levels_[0].resize(grey.cols, grey.rows);
  grey.copyTo(levels_[0].image_);
  levels_[0].fill_margin();
  for (std::size_t i = 1; i < levels_.size(); ++i) {
    const cv::Mat& finer = levels_[i - 1].image_;
    levels_[i].resize((finer.cols + 1) / 2, (finer.rows + 1) / 2);
    cv::pyrDown(finer, levels_[i].image_, levels_[i].image_.size());
    levels_[i].fill_margin();
  }
}

}  // namespace coslam
