// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/decode.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string_view>
#include <vector>

#include "common/base/error.h"

namespace coslam {
namespace {

using Bytes = std::vector<unsigned char>;

Bytes read_bytes(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

bool is_cut_off(const Bytes& bytes, std::string_view start, std::string_view end) {
  constexpr std::size_t kPadding = 1024;  // some cameras pad their files
  const std::string_view all(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return all.starts_with(start) && all.substr(all.size() - std::min(all.size(), kPadding)).find(end) == all.npos;
}

// Told by the end marker: libjpeg fills the missing rest with grey and reports success, libpng writes to standard
// error.
bool is_truncated(const Bytes& bytes) {
  return is_cut_off(bytes, "\xff\xd8", "\xff\xd9") || is_cut_off(bytes, "\x89PNG", "IEND");
}

std::string size_text(int width, int height) { return std::to_string(width) + "x" + std::to_string(height); }

}  // namespace

cv::Mat GreyReader::read(const std::filesystem::path& file) { return decode(read_bytes(file)); }

cv::Mat GreyReader::decode(const Bytes& octets) {
  if (octets.empty() || is_truncated(octets)) return {};
  try {
    // The calibration is of the sensor's pixels, so a photo's orientation tag is not obeyed.
    cv::Mat grey = cv::imdecode(octets, cv::IMREAD_GRAYSCALE | cv::IMREAD_ANYDEPTH | cv::IMREAD_IGNORE_ORIENTATION);
    if (grey.depth() == CV_8U) return grey;
    if (grey.depth() != CV_16U) return {};
    if (deep_bits_ == 0) {
      double brightest = 0;
      cv::minMaxLoc(grey, nullptr, &brightest);
      deep_bits_ = brightest < 1 << 10 ? 10 : brightest < 1 << 12 ? 12 : brightest < 1 << 14 ? 14 : 16;
    }
    cv::Mat out;
    grey.convertTo(out, CV_8U, 255.0 / ((1 << deep_bits_) - 1));
    return out;
  } catch (const cv::Exception&) {
    return {};
  }
}

cv::Mat read_color(const std::filesystem::path& file) {
  try {
    const cv::Mat image =
        cv::imdecode(read_bytes(file), cv::IMREAD_ANYCOLOR | cv::IMREAD_ANYDEPTH | cv::IMREAD_IGNORE_ORIENTATION);
    return image.type() == CV_8UC3 ? image : cv::Mat();
  } catch (const cv::Exception&) {
    return {};
  }
}

cv::Mat to_grey(const cv::Mat& frame) {
  if (frame.empty() || frame.depth() != CV_8U) return {};
  cv::Mat grey;
  if (frame.channels() == 1) {
    grey = frame.clone();  // the reader owns the buffer behind `frame`
  } else if (frame.channels() == 3) {
    cv::cvtColor(frame, grey, cv::COLOR_BGR2GRAY);
  } else if (frame.channels() == 4) {
    cv::cvtColor(frame, grey, cv::COLOR_BGRA2GRAY);
  }
  return grey;
}

void require_size(const cv::Mat& image, const SourceOptions& options, const std::string& image_name) {
  if (options.width_px <= 0 || options.height_px <= 0) return;
  if (image.cols == options.width_px && image.rows == options.height_px) return;
  throw UserError(image_name + " is " + size_text(image.cols, image.rows) + " pixels, but the calibration " +
                  (options.calibration.empty() ? "" : options.calibration + " ") + "is for " +
                  size_text(options.width_px, options.height_px));
}

}  // namespace coslam
