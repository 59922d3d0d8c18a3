// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "agent/capture/source.h"

namespace coslam {

// The images of one source's files, as CV_8UC1. Of images with 16 bits a pixel the first one tells how many bits the
// sensor has (10, 12, 14 or 16), and all are brought to 8 by that.
class GreyReader {
 public:
  // Empty when the file is missing, truncated or no image.
  cv::Mat read(const std::filesystem::path& file);
  // The same of what stands in such a file.
  cv::Mat decode(const std::vector<unsigned char>& octets);
  // Bits of the sensor; 0 while no image had more than 8.
  int deep_bits() const { return deep_bits_; }

 private:
  int deep_bits_ = 0;
};

// The image of a file as CV_8UC3; empty when it has no colours or more than 8 bits a pixel and colour.
cv::Mat read_color(const std::filesystem::path& file);

// CV_8UC1 of a frame as a video or camera delivers it; empty for a format that is none.
cv::Mat to_grey(const cv::Mat& frame);

// Throws UserError when the source's first image has not the calibration's size.
void require_size(const cv::Mat& image, const SourceOptions& options, const std::string& image_name);

}  // namespace coslam
