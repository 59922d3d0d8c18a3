// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/decode.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "agent/capture/two_views.h"
#include "common/base/error.h"
#include "common/base/printed.h"
#include "common/image/image_file.h"

namespace coslam {
namespace {

constexpr double kMostLevel = 65535;

std::string size_text(int width, int height) { return std::to_string(width) + "x" + std::to_string(height); }

}  // namespace

cv::Mat GreyReader::read(const std::filesystem::path& file) { return decode(read_octets(file)); }

cv::Mat GreyReader::decode(std::span<const std::uint8_t> octets) { return in_8_bits(decode_grey(octets)); }

cv::Mat GreyReader::decode(RawImage raw) {
  if (octet_order_.is_wrong_in(raw)) raw.big_endian = !raw.big_endian;
  return grey_of(raw);
}

cv::Mat GreyReader::in_8_bits(const cv::Mat& grey) {
  if (grey.type() == CV_8UC1) return grey;
  return grey.type() == CV_16UC1 ? deep_.spread(grey) : cv::Mat();
}

std::string GreyReader::bit_depth_note() const {
  if (!deep_.limits()) return {};
  const auto level = [](double limit) { return std::to_string(std::lround(std::clamp(limit, 0.0, kMostLevel))); };
  return std::string(octet_order_.is_wrong() ? "the octets of its pixels lie the other way round than it says; " : "") +
         "images of more than 8 bits; what lies between the levels " + level(deep_.limits()->low) + " and " +
         level(deep_.limits()->high) + " is spread over 8, by limits that follow the light slowly";
}

cv::Mat DeepLevels::spread(const cv::Mat& deep) {
  constexpr int kSamples = 20'000;
  constexpr double kTail = 0.005, kBeside = 0.1, kFollow = 0.05, kMostOutside = 0.05;
  constexpr double kLeastWidth = 64;  // levels; less is noise
  const int step = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(deep.total()) / kSamples)));
  std::vector<std::uint16_t> levels;
  for (int y = step / 2; y < deep.rows; y += step) {
    const auto* row = deep.ptr<std::uint16_t>(y);
    for (int x = step / 2; x < deep.cols; x += step) levels.push_back(row[x]);
  }
  if (levels.empty()) return {};
  std::ranges::sort(levels);
  const auto tail = static_cast<std::size_t>(kTail * static_cast<double>(levels.size()));
  const double low = levels[tail], high = levels[levels.size() - 1 - tail];
  const double middle = 0.5 * (low + high), half = (0.5 + kBeside) * std::max(kLeastWidth, high - low);
  const Limits now{middle - half, middle + half};
  double follow = 1;
  if (limits_) {
    const auto below = std::ranges::lower_bound(levels, limits_->low) - levels.begin();
    const auto above = levels.end() - std::ranges::upper_bound(levels, limits_->high);
    const bool outside = static_cast<double>(below + above) > kMostOutside * static_cast<double>(levels.size());
    follow = outside ? 1 : kFollow;
  } else {
    limits_ = now;
  }
  limits_->low += follow * (now.low - limits_->low);
  limits_->high += follow * (now.high - limits_->high);
  const double scale = 255 / (limits_->high - limits_->low);
  cv::Mat out;
  deep.convertTo(out, CV_8U, scale, -scale * limits_->low);
  return out;
}

cv::Mat read_color(const std::filesystem::path& file) {
  const cv::Mat image = decode_unchanged(read_octets(file));
  if (image.type() != CV_8UC4) return image.type() == CV_8UC3 ? image : cv::Mat();
  cv::Mat colors;
  cv::cvtColor(image, colors, cv::COLOR_BGRA2BGR);
  return colors;
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

ImageFault size_fault(const cv::Mat& image, cv::Size expected) {
  if (image.empty()) return ImageFault::kUnreadable;
  return image.size() == expected ? ImageFault::kNone : ImageFault::kResized;
}

namespace {

// What helps where a calibration is for images of another size.
std::string remedy(const cv::Mat& image, const SourceOptions& options) {
  constexpr double kSame = 0.01;
  if (image.cols == 2 * options.width_px && image.rows == options.height_px) {
    return ". If it is two pictures side by side, " + how_to_split(image.cols);
  }
  if (image.cols == options.height_px && image.rows == options.width_px) {
    return ": the one is turned by 90 degrees; turn the images, or leave the calibration out, and the lens is found";
  }
  const double x = static_cast<double>(image.cols) / options.width_px;
  const double y = static_cast<double>(image.rows) / options.height_px;
  if (std::abs(x / y - 1) < kSame) {
    return printed(
        ". If the images were scaled, so are fx, fy, cx and cy: times %.4g; without a calibration the lens is "
        "found",
        x);
  }
  return ". Is it cropped, or of another mode of the camera? Without a calibration the lens is found";
}

}  // namespace

void require_size(const cv::Mat& image, const SourceOptions& options, const std::string& image_name) {
  if (options.width_px <= 0 || options.height_px <= 0) return;
  if (image.cols == options.width_px && image.rows == options.height_px) return;
  throw UserError(image_name + " is " + size_text(image.cols, image.rows) + " pixels, but the calibration " +
                  (options.calibration.empty() ? "" : options.calibration + " ") + "is for " +
                  size_text(options.width_px, options.height_px) + remedy(image, options));
}

}  // namespace coslam
