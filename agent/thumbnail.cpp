// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/thumbnail.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "common/image/image_file.h"
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
    jpeg = encode_jpeg(small, quality, true);
    if (jpeg.size() <= kMostThumbnailBytes) return jpeg;
  }
  cv::resize(cv::Mat(small), small, {}, 0.5, 0.5, cv::INTER_AREA);
  return encode_jpeg(small, 12, true);
}

}  // namespace coslam
