// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace coslam {

// An image as a camera or a recording has it, by the names of ROS's sensor_msgs/Image.
struct RawImage {
  std::size_t width_px = 0, height_px = 0;
  std::string_view encoding;
  bool big_endian = false;         // octet order of pixels with 16 bits a value
  std::size_t octets_per_row = 0;  // length of a row of the first plane, padding included
  std::span<const std::uint8_t> octets;
};

// Grey, CV_8UC1 or CV_16UC1: luma as it is, colours by the weights that luma has, Bayer patterns interpolated. Empty:
// an encoding that is not known, or fewer octets than it takes.
cv::Mat grey_of(const RawImage& image);

// Whether images with 16 bits a value have their octets in the other order than they say, as of drivers that pass on
// what the sensor sent: neighbouring pixels then differ by as much as any two. The first image that tells counts for
// all of a source. For one thread.
class OctetOrder {
 public:
  bool is_wrong_in(const RawImage& image);
  bool is_wrong() const { return wrong_.value_or(false); }  // result so far

 private:
  std::optional<bool> wrong_;
};

// Why grey_of() is empty, for the user.
std::string why_not_grey(const RawImage& image);

bool is_known_encoding(std::string_view encoding);
// List of the known encodings, for the user.
std::string known_encodings();

}  // namespace coslam
