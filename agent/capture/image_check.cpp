// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/image_check.h"

#include <algorithm>
#include <cstring>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace coslam {
namespace {

bool same_rows(const cv::Mat& a, int row_a, const cv::Mat& b, int row_b) {
  return std::memcmp(a.ptr(row_a), b.ptr(row_b), static_cast<std::size_t>(a.cols)) == 0;
}

// Most differ in their first row, so it costs nothing.
bool same_image(const cv::Mat& a, const cv::Mat& b) {
  if (a.size() != b.size()) return false;
  for (int y = 0; y < a.rows; ++y) {
    if (!same_rows(a, y, b, y)) return false;
  }
  return true;
}

// FNV-1a over words of every 16th row.
std::uint64_t print_of(const cv::Mat& grey) {
  constexpr int kRows = 16;
  constexpr std::uint64_t kBasis = 14695981039346656037U, kPrime = 1099511628211U;
  std::uint64_t print = kBasis;
  for (int y = kRows / 2; y < grey.rows; y += kRows) {
    const std::uint8_t* row = grey.ptr(y);
    for (int x = 0; x + 8 <= grey.cols; x += 8) {
      std::uint64_t word = 0;
      std::memcpy(&word, row + x, sizeof word);
      print = (print ^ word) * kPrime;
    }
  }
  return print;
}

// Rows at the end that are all the same. What is clipped, black or white, is so by nature.
int band_at_end(const cv::Mat& grey) {
  constexpr int kBlack = 20, kWhite = 235;
  int rows = 1;
  while (rows < grey.rows && same_rows(grey, grey.rows - 1, grey, grey.rows - 1 - rows)) ++rows;
  if (rows == 1) return 0;
  double least = 0, most = 0;
  cv::minMaxLoc(grey.row(grey.rows - 1), &least, &most);
  return most <= kBlack || least >= kWhite ? 0 : rows;
}

// Noise is gone in means of 8x8 pixels; what is left of a scene that can be followed is more than this.
bool is_featureless(const cv::Mat& grey) {
  constexpr int kBlock = 8;
  constexpr double kLeastSpread = 4, kTail = 0.01;  // grey values
  cv::Mat blocks;
  cv::resize(grey, blocks, {std::max(1, grey.cols / kBlock), std::max(1, grey.rows / kBlock)}, 0, 0, cv::INTER_AREA);
  std::array<int, 256> histogram{};
  for (int y = 0; y < blocks.rows; ++y) {
    const std::uint8_t* row = blocks.ptr(y);
    for (int x = 0; x < blocks.cols; ++x) ++histogram[row[x]];
  }
  const int tail = static_cast<int>(kTail * static_cast<double>(blocks.total()));
  int low = 0, high = 255;
  for (int below = histogram[0]; below <= tail && low < 255;) below += histogram[static_cast<std::size_t>(++low)];
  for (int above = histogram[255]; above <= tail && high > 0;) above += histogram[static_cast<std::size_t>(--high)];
  return high - low < kLeastSpread;
}

}  // namespace

ImageFault ImageCheck::check(const Image& image) {
  if (image.fault != ImageFault::kNone) return image.fault;
  const cv::Mat& grey = image.grey;
  if (grey.empty()) return ImageFault::kUnreadable;
  const bool repeated = same_image(grey, last_);
  last_ = grey;
  if (repeated) return ImageFault::kRepeated;
  if (is_from_earlier(grey)) return ImageFault::kOutOfOrder;
  const int band = band_at_end(grey);
  const int usual = std::min(usual_band_.value_or(band), band);
  usual_band_ = usual;
  if (band - usual >= std::max(16, grey.rows / 16)) return ImageFault::kCutOff;
  return is_featureless(grey) ? ImageFault::kFeatureless : ImageFault::kNone;
}

bool ImageCheck::is_from_earlier(const cv::Mat& grey) {
  const std::uint64_t print = print_of(grey);
  const std::size_t kept = std::min(images_, earlier_.size());
  const bool known = std::find(earlier_.begin(), earlier_.begin() + static_cast<std::ptrdiff_t>(kept), print) !=
                     earlier_.begin() + static_cast<std::ptrdiff_t>(kept);
  earlier_[images_++ % earlier_.size()] = print;
  return known;
}

void ImageVerdict::note(ImageFault fault, TimeNs t_ns) {
  constexpr TimeNs kPatience_ns = 200'000'000, kWindow_ns = 1'000'000'000;
  last_second_.push_back({t_ns, fault});
  while (last_second_.front().t_ns <= t_ns - kWindow_ns) last_second_.pop_front();
  if (fault == ImageFault::kNone || !good_ns_) good_ns_ = t_ns;
  // Damaged now and then: what is not noticed may be damaged, too. A stream that gives every image twice is sound.
  const auto damaged = [](const Noted& n) {
    return n.fault == ImageFault::kUnreadable || n.fault == ImageFault::kConcealed || n.fault == ImageFault::kCutOff ||
           n.fault == ImageFault::kOutOfOrder;
  };
  const auto often = std::ranges::count_if(last_second_, damaged);
  if (t_ns - *good_ns_ >= kPatience_ns) {
    verdict_ = fault;
  } else if (often >= 2 && often * 4 > std::ssize(last_second_)) {
    verdict_ = std::find_if(last_second_.rbegin(), last_second_.rend(), damaged)->fault;
  } else if (fault == ImageFault::kNone || verdict_ == ImageFault::kNone) {
    verdict_ = ImageFault::kNone;
  }
}

}  // namespace coslam
