// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/descriptors.h"

#include <algorithm>
#include <numeric>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

namespace coslam {

namespace {

constexpr double kContrast = 0.015;  // threshold of SIFT: it is to find something in dim rooms too

DescribedFeatures detect(cv::SIFT& sift, const cv::Mat& grey, const cv::Mat& mask, int most, double border_px) {
  std::vector<cv::KeyPoint> found;
  cv::Mat descriptors;
  sift.detectAndCompute(grey, mask, found, descriptors);
  std::vector<std::size_t> strongest(found.size());
  std::iota(strongest.begin(), strongest.end(), std::size_t{0});
  std::stable_sort(strongest.begin(), strongest.end(),
                   [&](std::size_t a, std::size_t b) { return found[a].response > found[b].response; });
  DescribedFeatures out;
  for (const std::size_t i : strongest) {
    if (static_cast<int>(out.raw_px.size()) == most) break;
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
    for (int k = 0; k < kDescriptorBytes; ++k) {
      out.descriptors.push_back(quantised_descriptor(static_cast<std::uint8_t>(d[k])));
    }
  }
  return out;
}

}  // namespace

DescribedFeatures describe(const cv::Mat& grey, int most, double border_px) {
  return detect(*cv::SIFT::create(most, 3, kContrast), grey, {}, most, border_px);
}

DescribedFeatures describe_near(const cv::Mat& grey, const std::vector<Eigen::Vector2f>& raw_px, float near_px,
                                int most, double border_px) {
  cv::Mat mask = cv::Mat::zeros(grey.size(), CV_8UC1);
  for (const Eigen::Vector2f& px : raw_px) {
    cv::circle(mask, {cvRound(px.x()), cvRound(px.y())}, static_cast<int>(near_px), {255}, cv::FILLED);
  }
  return detect(*cv::SIFT::create(0, 3, kContrast), grey, mask, most, border_px);
}

}  // namespace coslam
