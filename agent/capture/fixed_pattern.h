// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

namespace coslam {

// Whether a pattern stays in the picture wherever the camera looks, as dots that are projected along with it: of the
// differences between neighbouring pixels a good part is the same in images that show something else. In most of the
// picture, or else it is something that moves with the camera. Pure; for one thread.
class FixedPattern {
 public:
  // Each image, CV_8UC1, with the means of its blocks.
  void note(const cv::Mat& grey, const cv::Mat& blocks);
  // Whether a pattern was found in the images so far.
  bool found() const { return found_; }

 private:
  cv::Mat last_blocks_;  // block means of the newest image that counts
  cv::Mat mean_;         // mean of the differences so far
  int images_ = 0;       // number of images with different content
  int in_succession_ = 0;
  bool found_ = false;
};

}  // namespace coslam
