// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/descriptors.h"

#include <algorithm>
#include <opencv2/features2d.hpp>

namespace coslam {

DescribedFeatures describe(const cv::Mat& grey, int most, double border_px) {
  const auto sift = cv::SIFT::create(most, 3, 0.015);
  std::vector<cv::KeyPoint> found;
  cv::Mat descriptors;
  sift->detectAndCompute(grey, cv::noArray(), found, descriptors);
  DescribedFeatures out;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Eigen::Vector2f px(found[i].pt.x, found[i].pt.y);
    const auto b = static_cast<float>(border_px);
    if (px.x() < b || px.y() < b || px.x() > static_cast<float>(grey.cols - 1) - b ||
        px.y() > static_cast<float>(grey.rows - 1) - b)
      continue;
    const bool twice =
        std::any_of(out.raw_px.begin(), out.raw_px.end(), [&](const auto& o) { return (o - px).squaredNorm() < 9.0F; });
    if (twice) continue;
    out.raw_px.push_back(px);
    const float* d = descriptors.ptr<float>(static_cast<int>(i));
    for (int k = 0; k < kDescriptorBytes; ++k) out.descriptors.push_back(static_cast<std::uint8_t>(d[k]));
  }
  return out;
}

}  // namespace coslam
