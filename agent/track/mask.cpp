// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/mask.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>

#include "common/base/error.h"
#include "common/image/image_file.h"

namespace coslam {
namespace {

constexpr double kBrightShare = 127.0 / 255;  // what is darker than this share of white is masked

double largest(const cv::Mat& image) {
  double most = 0;
  cv::minMaxLoc(image, nullptr, &most);
  return most;
}

// Of the opaque part of a picture, which is neither empty nor all of it.
cv::Mat by_transparency(const std::string& file, const cv::Mat& opaque, const cv::Mat& bright) {
  constexpr double kFew = 0.01;
  const double bright_share = cv::countNonZero(bright & opaque) / static_cast<double>(cv::countNonZero(opaque));
  if (bright_share < kFew) return ~opaque;
  if (bright_share > 1 - kFew) return opaque;
  throw UserError("the mask " + file +
                  " has transparent parts beside dark and bright ones: save it without transparency, black where "
                  "nothing is to be followed");
}

// A photo has many grey levels; a mask has two, and a few between them where its edges are soft.
bool is_photo(const cv::Mat& grey) {
  constexpr std::ptrdiff_t kMany = 32;
  constexpr double kSome = 1.0 / 2000;  // of the picture in one level
  cv::Mat levels;
  grey.convertTo(levels, CV_8U, 255 / std::max(largest(grey), 1e-6));
  std::array<int, 256> counts{};
  for (auto at = levels.begin<std::uint8_t>(); at != levels.end<std::uint8_t>(); ++at) ++counts[*at];
  const double least_count = kSome * static_cast<double>(levels.total());
  return std::ranges::count_if(counts, [&](int count) { return count > least_count; }) >= kMany;
}

cv::Mat followed(const std::string& file, const cv::Mat& image) {
  if (image.channels() == 1) {
    if (is_photo(image))
      throw UserError("the mask " + file +
                      " is a picture of many grey levels: it is to be black where nothing is to be followed, and white "
                      "elsewhere");
    return image > kBrightShare * largest(image);
  }
  cv::Mat grey, alpha;
  cv::cvtColor(image, grey, image.channels() == 4 ? cv::COLOR_BGRA2GRAY : cv::COLOR_BGR2GRAY);
  if (image.channels() == 3) return followed(file, grey);
  cv::extractChannel(image, alpha, 3);
  const double full = largest(alpha);
  const cv::Mat opaque = alpha > kBrightShare * full;
  if (full == 0 || cv::countNonZero(opaque) == static_cast<int>(opaque.total())) return followed(file, grey);
  return by_transparency(file, opaque, grey > kBrightShare * full);
}

}  // namespace

cv::Mat read_mask(const std::string& file) {
  const cv::Mat image = decode_unchanged(read_octets(file));
  if (image.empty() || (image.channels() != 1 && image.channels() < 3))
    throw UserError("the mask " + file + " cannot be read");
  cv::Mat out = followed(file, image);
  if (cv::countNonZero(out) == 0)
    throw UserError("the mask " + file + " leaves out the whole image: it is to be white where something is followed");
  return out;
}

MaskWord word_of(const std::string& file, const cv::Mat& mask) {
  constexpr double kMost = 0.6;  // of an image that a camera is of use with
  const double left_out = 1 - cv::countNonZero(mask) / static_cast<double>(mask.total());
  const std::string percent = std::to_string(std::lround(100 * left_out));
  const std::string text =
      "the mask " + file + " leaves out " + (left_out > 0 ? percent + " %" : "nothing") + " of the image";
  if (left_out > 0 && left_out <= kMost) return {text};
  return {text + ": perhaps it is inverted; black is where nothing is to be followed", true};
}

}  // namespace coslam
