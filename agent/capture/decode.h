// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>
#include <string>

#include "agent/capture/encodings.h"
#include "agent/capture/source.h"

namespace coslam {

// Brings images of more than 8 bits a pixel to 8. Of a sensor's levels a scene takes few, in a thermal camera some
// hundred of 16384: those from the 0.5th to the 99.5th percentile, and some on either side, are spread over 8 bits. The
// limits follow the light slowly, and at once where more than a twentieth of the pixels lies outside.
class DeepLevels {
 public:
  // CV_16UC1 to CV_8UC1.
  cv::Mat spread(const cv::Mat& deep);
  struct Limits {
    double low = 0, high = 0;
  };
  // Limits of the newest such image; empty while there was none.
  const std::optional<Limits>& limits() const { return limits_; }

 private:
  std::optional<Limits> limits_;
};

// The images of one source, as CV_8UC1.
class GreyReader {
 public:
  // Reads an image file; empty when it is missing, truncated or no image.
  cv::Mat read(const std::filesystem::path& file);
  // Decodes the content of such a file.
  cv::Mat decode(std::span<const std::uint8_t> octets);
  // Converts an image without a file format, of 8 or 16 bits, as grey_of() has it. Swapped octets of 16-bit values are
  // recognised and put right.
  cv::Mat decode(RawImage raw);
  // CV_8UC1 or CV_16UC1; empty for any other.
  cv::Mat in_8_bits(const cv::Mat& grey);
  // A sentence for the user where images have more than 8 bits; else empty.
  std::string bit_depth_note() const;

 private:
  DeepLevels deep_;
  OctetOrder octet_order_;
};

// The image of a file as CV_8UC3; empty when it has no colours or more than 8 bits a pixel and colour.
cv::Mat read_color(const std::filesystem::path& file);

// CV_8UC1 of a frame as a video or camera delivers it; empty for a format that is none.
cv::Mat to_grey(const cv::Mat& frame);

// kNone for an image of that size.
ImageFault size_fault(const cv::Mat& image, cv::Size expected);

// Throws UserError when the source's first image has not the calibration's size.
void require_size(const cv::Mat& image, const SourceOptions& options, const std::string& image_name);

}  // namespace coslam
