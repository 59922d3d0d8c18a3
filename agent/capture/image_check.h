// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "agent/capture/alternation.h"
#include "agent/capture/fixed_pattern.h"
#include "agent/track/image.h"
#include "common/model/image_fault.h"

namespace coslam {

// Finds faults of an image from its pixels and those of the same camera before it. A sensor's noise makes no two images
// the same, and so does motion: an image that repeats an earlier one bit by bit is a fault when the camera was moving,
// or when its noise was seen. Images of a simulator may repeat, and those of a video that codes what stands still as
// the same. Pure; for one thread.
class ImageCheck {
 public:
  // Images in their order; what the source found wrong already stands.
  ImageFault check(const Image& image);
  // Something was found to stay in the picture wherever the camera looks, as dots that are projected along with it.
  bool pattern_stays() const { return fixed_pattern_.found(); }

 private:
  bool is_out_of_order(const cv::Mat& grey);
  bool is_cut_off(const cv::Mat& grey);
  bool is_torn(const cv::Mat& grey);
  void compare(const cv::Mat& grey, const cv::Mat& blocks);
  void note_noise(bool noise);
  bool never_repeats() const;
  bool note_repeat();

  cv::Mat last_, last_blocks_;  // the newest image that was not the one before, and the means of its blocks
  std::array<std::uint64_t, 32> earlier_{};  // prints of the newest images
  std::size_t images_ = 0;
  std::size_t back_ = 0;  // how many images before the newest one it was there already; 0: it was not
  int repeats_ = 0;       // repetitions of last_, in succession
  int since_repeat_ = 0, last_gap_ = 0, same_gaps_ = 0;  // images from one repeat to the next
  bool whole_moved_ = false;                             // the whole picture moved from the image before to last_
  std::deque<bool> noise_;  // for the newest pairs that show the same: whether each row differed
  Alternation alternation_;
  FixedPattern fixed_pattern_;
  std::optional<int> usual_same_;  // rows of 16 that are as in the image before, in the best image so far: a rim
  std::optional<int> usual_band_;  // rows at the end that are alike, in the best image so far: a rim
};

// Whether a camera's images as a whole are to be believed. They are not, from when none was good for 0.2 s or much
// longer than usual, or from when more than a quarter of those of the last second came damaged or out of order. Pure;
// for one thread.
class ImageVerdict {
 public:
  // t_ns: of a clock that does not go back.
  void note(ImageFault fault, TimeNs t_ns);
  // kNone: they are. The reason stays the first one until they are again.
  ImageFault verdict() const { return verdict_; }

 private:
  struct Noted {
    TimeNs t_ns = 0;
    ImageFault fault = ImageFault::kNone;
  };
  TimeNs patience_ns() const;

  std::deque<Noted> last_second_;
  std::optional<TimeNs> good_ns_;              // the newest good one, or the first of all
  std::array<TimeNs, 8> good_intervals_ns_{};  // the newest ones
  std::size_t good_ = 0;
  ImageFault verdict_ = ImageFault::kNone;
};

}  // namespace coslam
