// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/image_check.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <opencv2/imgproc.hpp>
#include <utility>

namespace coslam {
namespace {

constexpr std::size_t kPairs = 20;  // of images that show the same, that tell whether there is noise

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

// FNV-1a over its words.
std::uint64_t print_of(const cv::Mat& grey) {
  constexpr std::uint64_t kBasis = 14695981039346656037U, kPrime = 1099511628211U;
  std::uint64_t print = kBasis;
  for (int y = 0; y < grey.rows; ++y) {
    const std::uint8_t* row = grey.ptr(y);
    int x = 0;
    for (; x + 8 <= grey.cols; x += 8) {
      std::uint64_t word = 0;
      std::memcpy(&word, row + x, sizeof word);
      print = (print ^ word) * kPrime;
    }
    for (; x < grey.cols; ++x) print = (print ^ row[x]) * kPrime;
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

// Neighbouring rows above the band that are the same: it has no noise, and a plain floor is a band by nature.
bool has_equal_neighbours(const cv::Mat& grey, int band) {
  constexpr int kStep = 4;
  for (int y = 1; y < grey.rows - band; y += kStep) {
    if (same_rows(grey, y, grey, y - 1)) return true;
  }
  return false;
}

cv::Mat means_of_blocks(const cv::Mat& grey) {
  constexpr int kBlock = 8;
  cv::Mat blocks;
  cv::resize(grey, blocks, {std::max(1, grey.cols / kBlock), std::max(1, grey.rows / kBlock)}, 0, 0, cv::INTER_AREA);
  return blocks;
}

// By how much neighbouring pixels differ in the mean.
double mean_step(const cv::Mat& grey) {
  constexpr int kStep = 16;  // rows
  const int rows = (grey.rows + kStep - 1) / kStep;
  std::int64_t sum = 0;
  for (int y = 0; y < grey.rows; y += kStep) {
    const std::uint8_t* row = grey.ptr(y);
    for (int x = 1; x < grey.cols; ++x) sum += std::abs(row[x] - row[x - 1]);
  }
  return static_cast<double>(sum) / std::max(1, rows * (grey.cols - 1));
}

// Noise is gone in means of 8x8 pixels, but for an eighth: where blocks differ by less than neighbouring pixels do, as
// in the picture of no signal, nothing else is there. What is left of a scene that can be followed is more. A few
// lights in the dark are something.
bool is_featureless(const cv::Mat& blocks, double step) {
  constexpr int kLeastSpread = 4, kFew = 15;  // grey values, blocks
  std::array<int, 256> histogram{};
  for (int y = 0; y < blocks.rows; ++y) {
    const std::uint8_t* row = blocks.ptr(y);
    for (int x = 0; x < blocks.cols; ++x) ++histogram[row[x]];
  }
  const int few = std::min(kFew, static_cast<int>(blocks.total()) / 50);
  int low = 0, high = 255;
  for (int below = histogram[0]; below <= few && low < 255;) below += histogram[static_cast<std::size_t>(++low)];
  for (int above = histogram[255]; above <= few && high > 0;) above += histogram[static_cast<std::size_t>(--high)];
  return high - low < std::max<double>(kLeastSpread, step);
}

}  // namespace

ImageFault ImageCheck::check(const Image& image) {
  if (image.fault != ImageFault::kNone) return image.fault;
  const cv::Mat& grey = image.grey;
  ++since_repeat_;
  if (grey.empty()) return ImageFault::kUnreadable;
  if (same_image(grey, last_)) {
    // A camera that is late now and then gives one again, which is used as ever.
    const bool again = ++repeats_ > 1 || note_repeat();
    if (never_repeats() && again) return ImageFault::kRepeated;
    if (!never_repeats()) compare(grey, last_blocks_);
    return is_featureless(last_blocks_, mean_step(grey)) ? ImageFault::kFeatureless : ImageFault::kNone;
  }
  const cv::Mat blocks = means_of_blocks(grey);
  // What came again may do so by nature; it is not called noise soon.
  if (std::exchange(repeats_, 0) > 1) note_noise(false);
  const bool old = is_out_of_order(grey) && never_repeats(), torn = is_torn(grey);
  compare(grey, blocks);
  last_ = grey;
  last_blocks_ = blocks;
  if (old) return ImageFault::kOutOfOrder;
  if (torn) return ImageFault::kConcealed;
  if (is_cut_off(grey)) return ImageFault::kCutOff;
  const double step = mean_step(grey);
  if (is_featureless(blocks, step)) return ImageFault::kFeatureless;
  if (alternation_.leaves_out(blocks, step)) return ImageFault::kAlternating;
  fixed_pattern_.note(grey, blocks);
  return ImageFault::kNone;
}

// The newest image is the one before. True: so was, for the third time, one as many images earlier: its stream has more
// images than its camera, and their times are not when they were taken.
bool ImageCheck::note_repeat() {
  constexpr int kMostGap = 3, kRegular = 3;
  const int gap = std::exchange(since_repeat_, 0);
  same_gaps_ = gap == std::exchange(last_gap_, gap) ? same_gaps_ + 1 : 0;
  return gap <= kMostGap && same_gaps_ >= kRegular;
}

// A picture of which all moves, or noise in all the newest that show the same.
bool ImageCheck::never_repeats() const {
  return whole_moved_ || (noise_.size() == kPairs && std::ranges::all_of(noise_, std::identity()));
}

void ImageCheck::compare(const cv::Mat& grey, const cv::Mat& blocks) {
  constexpr int kRows = 16;
  constexpr double kMoves = 1;  // mean change of a block, grey values
  if (last_.size() != grey.size()) return;
  bool all_rows_change = true;
  for (int y = kRows / 2; y < grey.rows && all_rows_change; y += kRows) all_rows_change = !same_rows(grey, y, last_, y);
  const double change = cv::norm(blocks, last_blocks_, cv::NORM_L1) / static_cast<double>(blocks.total());
  whole_moved_ = all_rows_change && change > kMoves;
  if (change > kMoves) return;
  note_noise(all_rows_change);
}

void ImageCheck::note_noise(bool noise) {
  noise_.push_back(noise);
  if (noise_.size() > kPairs) noise_.pop_front();
}

bool ImageCheck::is_cut_off(const cv::Mat& grey) {
  const int band = band_at_end(grey);
  const int usual = std::min(usual_band_.value_or(band), band);
  usual_band_ = usual;
  return band - usual >= std::max(16, grey.rows / 16) && !has_equal_neighbours(grey, band);
}

// Rows of the image before, bit by bit, beside others of which all moved: a buffer was read while it was written.
bool ImageCheck::is_torn(const cv::Mat& grey) {
  constexpr int kStep = 16;
  if (last_.size() != grey.size()) return false;
  int same = 0;
  for (int y = kStep / 2; y < grey.rows; y += kStep) {
    const std::uint8_t* row = grey.ptr(y);
    const bool plain = std::memcmp(row, row + 1, static_cast<std::size_t>(grey.cols) - 1) == 0;  // a white sky
    same += !plain && same_rows(grey, y, last_, y) ? 1 : 0;
  }
  const int usual = std::min(usual_same_.value_or(same), same);
  usual_same_ = usual;
  const bool many = same - usual >= std::max(2, grey.rows / kStep / 8);
  return many && whole_moved_;
}

// A recording that is played back and forth goes two images farther back with each, from two where it turns; a driver's
// buffers do not.
bool ImageCheck::is_out_of_order(const cv::Mat& grey) {
  const std::uint64_t print = print_of(grey);
  const std::size_t last_back = std::exchange(back_, 0);
  for (std::size_t back = 1; back <= std::min(images_, earlier_.size()) && back_ == 0; ++back) {
    if (earlier_[(images_ - back) % earlier_.size()] == print) back_ = back;
  }
  earlier_[images_++ % earlier_.size()] = print;
  const bool turns = back_ == 2 && last_back != 2;
  return back_ > 0 && !turns && back_ != last_back + 2;
}

TimeNs ImageVerdict::patience_ns() const {
  constexpr TimeNs kLeast_ns = 200'000'000;
  return std::max(kLeast_ns, 5 * *std::ranges::max_element(good_intervals_ns_) / 2);
}

void ImageVerdict::note(ImageFault fault, TimeNs t_ns) {
  constexpr TimeNs kWindow_ns = 1'000'000'000;
  if (fault == ImageFault::kAlternating) return;  // it is sound, and so are those beside it
  if (!last_second_.empty() && t_ns < last_second_.back().t_ns) last_second_.clear();
  last_second_.push_back({t_ns, fault});
  while (last_second_.front().t_ns <= t_ns - kWindow_ns) last_second_.pop_front();
  const bool good = fault == ImageFault::kNone;
  if (!good_ns_ || t_ns < *good_ns_) good_ns_ = t_ns;
  const TimeNs since_good_ns = t_ns - *good_ns_;
  const bool too_long = !good && since_good_ns >= patience_ns();
  if (good) {
    // A time in which none was to be believed is no usual one.
    if (good_ > 0 && verdict_ == ImageFault::kNone)
      good_intervals_ns_[good_ % good_intervals_ns_.size()] = since_good_ns;
    ++good_;
    good_ns_ = t_ns;
  }
  // Damaged now and then: what is not noticed may be damaged, too. A stream that gives every image twice is sound.
  const auto damaged = [](const Noted& n) {
    return n.fault == ImageFault::kUnreadable || n.fault == ImageFault::kConcealed || n.fault == ImageFault::kCutOff ||
           n.fault == ImageFault::kOutOfOrder;
  };
  const auto count = std::ranges::count_if(last_second_, damaged);
  const bool often = count >= 2 && count * 4 > std::ssize(last_second_);
  if (!too_long && !often && good) verdict_ = ImageFault::kNone;
  if (verdict_ != ImageFault::kNone || (!too_long && !often)) return;
  verdict_ = too_long ? fault : std::find_if(last_second_.rbegin(), last_second_.rend(), damaged)->fault;
}

}  // namespace coslam
