// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "agent/track/image.h"
#include "common/model/image_fault.h"

namespace coslam {

// What an image tells of itself, next to those of the same camera before it. A sensor's noise makes no two images the
// same, so an image that was there before, bit by bit, is not what the camera sees now. Pure; for one thread.
class ImageCheck {
 public:
  // Images in their order; what the source found wrong already stands.
  ImageFault check(const Image& image);

 private:
  bool is_from_earlier(const cv::Mat& grey);

  cv::Mat last_;
  std::array<std::uint64_t, 32> earlier_{};  // prints of the newest images
  std::size_t images_ = 0;
  std::optional<int> usual_band_;  // rows at the end that are alike, in the best image so far: a rim
};

// Whether a camera's images as a whole are to be believed. They are not, from when none was good for 0.2 s, or from
// when more than a quarter of those of the last second came damaged or out of order. Pure; for one thread.
class ImageVerdict {
 public:
  // t_ns: capture times, or any other clock that does not go back.
  void note(ImageFault fault, TimeNs t_ns);
  // kNone: they are.
  ImageFault verdict() const { return verdict_; }

 private:
  struct Noted {
    TimeNs t_ns = 0;
    ImageFault fault = ImageFault::kNone;
  };
  std::deque<Noted> last_second_;
  std::optional<TimeNs> good_ns_;  // the newest good one, or the first of all
  ImageFault verdict_ = ImageFault::kNone;
};

}  // namespace coslam
