// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "common/video/picture.h"

// Image files: PNG and JPEG, and by FFmpeg, where it is installed, JPEG 2000, WebP, BMP, TIFF, PGM and its kin. The
// calibration is of the sensor's pixels, so a photo's orientation tag is not obeyed. Pixels are those that OpenCV
// reads.
namespace coslam {

// Decodes the content of an image file, CV_8UC1 or CV_16UC1; colours by the weights of luma. Empty: no image, or a
// damaged one, or of a form for which FFmpeg is not installed, which is said once.
cv::Mat decode_grey(std::span<const std::uint8_t> octets);
// Decodes it with the channels that it has: 1, 3 (blue, green, red) or 4 (the same and opacity), of 8 or 16 bits.
cv::Mat decode_unchanged(std::span<const std::uint8_t> octets);

// Content of a file; empty: it cannot be read.
std::vector<std::uint8_t> read_octets(const std::filesystem::path& file);

// Writes CV_8U or CV_16U of 1, 3 or 4 channels as PNG or CV_8U of 1 or 3 as JPEG, as the name of the file ends. False:
// it cannot be written, or its name ends in another way.
bool write_image_file(const std::filesystem::path& file, const cv::Mat& image);
// The content of a JPEG file of CV_8UC1 or CV_8UC3; quality: 0 to 100. optimize: smaller, and slower.
std::vector<std::uint8_t> encode_jpeg(const cv::Mat& image, int quality, bool optimize);

// Copy of what a decoder holds.
cv::Mat mat_of(const Picture& picture);

}  // namespace coslam
