// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/fixed_pattern.h"

#include <algorithm>
#include <opencv2/core.hpp>

namespace coslam {
namespace {

// By how much pixels differ from those beside them, in some of the rows.
cv::Mat differences_of(const cv::Mat& grey) {
  constexpr int kStep = 8, kBeside = 2;  // rows, pixels
  const int rows = grey.rows / kStep, columns = grey.cols - 2 * kBeside;
  cv::Mat out(rows, columns, CV_32F);
  for (int y = 0; y < rows; ++y) {
    const std::uint8_t* from = grey.ptr(y * kStep + kStep / 2) + kBeside;
    auto* to = out.ptr<float>(y);
    for (int x = 0; x < columns; ++x) to[x] = 2.0F * from[x] - from[x - kBeside] - from[x + kBeside];
  }
  return out;
}

// Its blocks are others, and not only brighter or darker ones. What is nearly plain tells nothing.
bool shows_something_else(const cv::Mat& blocks, const cv::Mat& before) {
  constexpr double kLeastContrast = 10, kAlike = 0.8;  // grey values, correlation
  cv::Scalar mean, deviation, mean_before, deviation_before;
  cv::meanStdDev(blocks, mean, deviation);
  cv::meanStdDev(before, mean_before, deviation_before);
  if (std::min(deviation[0], deviation_before[0]) < kLeastContrast) return false;
  const double together = blocks.dot(before) / static_cast<double>(blocks.total()) - mean[0] * mean_before[0];
  return together < kAlike * deviation[0] * deviation_before[0];
}

// In two thirds of the parts of the picture a quarter of what there is was there before.
bool most_stays(const cv::Mat& differences, const cv::Mat& mean) {
  constexpr int kColumns = 4, kRows = 3;
  constexpr double kStays = 0.25;
  const cv::Size part(differences.cols / kColumns, differences.rows / kRows);
  int staying = 0;
  for (int y = 0; y < kRows; ++y) {
    for (int x = 0; x < kColumns; ++x) {
      const cv::Rect at({x * part.width, y * part.height}, part);
      const cv::Mat now = differences(at);
      if (now.dot(mean(at)) > kStays * now.dot(now)) ++staying;
    }
  }
  return 3 * staying >= 2 * kColumns * kRows;
}

}  // namespace

void FixedPattern::note(const cv::Mat& grey, const cv::Mat& blocks) {
  constexpr int kEnough = 8, kMemory = 16, kLeastSize = 64;  // images; pixels
  if (found_ || std::min(grey.rows, grey.cols) < kLeastSize) return;
  if (last_blocks_.size() != blocks.size()) {
    images_ = in_succession_ = 0;
  } else if (!shows_something_else(blocks, last_blocks_)) {
    return;
  }
  last_blocks_ = blocks;
  const cv::Mat differences = differences_of(grey);
  if (images_++ == 0) {
    mean_ = differences;
    return;
  }
  if (images_ > kEnough) in_succession_ = most_stays(differences, mean_) ? in_succession_ + 1 : 0;
  found_ = in_succession_ == kEnough;
  cv::addWeighted(mean_, 1 - 1.0 / std::min(images_, kMemory), differences, 1.0 / std::min(images_, kMemory), 0, mean_);
}

}  // namespace coslam
