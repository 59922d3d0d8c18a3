// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace coslam {

// A mask as painting programs write it: 255 where something is followed, 0 where not. Dark is what is less than half as
// bright as the brightest, so that 0 and 1 do as well as 0 and 255. Of a picture with transparent parts black paint on
// a transparent sheet leaves out what is painted, a hole in a bright sheet leaves out the hole. Throws UserError for
// one that cannot be read, that is a photo, whose transparency may mean either, or that leaves out everything.
cv::Mat read_mask(const std::string& file);

// Sentence on what a mask leaves out, and whether that is so unusual that it may be a mistake.
struct MaskWord {
  std::string text;
  bool doubtful = false;
};
MaskWord word_of(const std::string& file, const cv::Mat& mask);

}  // namespace coslam
