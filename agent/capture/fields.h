// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

namespace coslam {

enum class Fields : std::uint8_t {
  kUnknown,     // too little has moved so far
  kNone,        // whole frames: all rows are of one time
  kUpperFirst,  // even rows are of the image's time, odd ones of half a frame later
  kLowerFirst,  // odd rows are of the image's time, even ones of half a frame later
};

// Tells interlaced images by how they move. From the even rows of an image to its odd rows the picture moves half as
// far as to the even rows of the next image, or half as far back where the odd rows are the earlier ones; in whole
// frames it does not move at all. Where something stands, there is nothing to tell, and nothing to lose. Pure; for one
// thread.
class FieldOrder {
 public:
  // The next image, CV_8UC1; what is known by then. Once it is known it stays.
  Fields note(const cv::Mat& grey);

 private:
  Fields vote(const cv::Mat& grey);

  cv::Mat last_;
  Fields voted_ = Fields::kUnknown, order_ = Fields::kUnknown;
  int votes_ = 0;     // for voted_, in succession
  int measured_ = 0;  // pairs of images
};

// Replaces every second row by the mean of those above and below: what is left is of one time.
void keep_first_field(cv::Mat& image, Fields order);

}  // namespace coslam
