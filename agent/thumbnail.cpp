// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/thumbnail.h"

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "common/model/thumbnail.h"

namespace coslam {

std::vector<std::uint8_t> thumbnail_jpeg(const cv::Mat& image) {
  std::vector<std::uint8_t> jpeg;
  if (image.empty()) return jpeg;
  cv::Mat small = image;
  const double scale = static_cast<double>(kThumbnailWidth_px) / std::max(image.cols, image.rows);
  if (scale < 1) cv::resize(image, small, {}, scale, scale, cv::INTER_AREA);
  // Noise takes most octets. Half the size has room for any of it.
  for (const int quality : {60, 40, 25, 12}) {
    cv::imencode(".jpg", small, jpeg, {cv::IMWRITE_JPEG_QUALITY, quality, cv::IMWRITE_JPEG_OPTIMIZE, 1});
    if (jpeg.size() <= kMostThumbnailBytes) return jpeg;
  }
  cv::resize(cv::Mat(small), small, {}, 0.5, 0.5, cv::INTER_AREA);
  cv::imencode(".jpg", small, jpeg, {cv::IMWRITE_JPEG_QUALITY, 12, cv::IMWRITE_JPEG_OPTIMIZE, 1});
  return jpeg;
}

}  // namespace coslam
