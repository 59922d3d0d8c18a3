// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/wide_baseline.h"

#include <opencv2/features2d.hpp>
#include <vector>

#include "agent/track/descriptors.h"

namespace coslam {
namespace {

constexpr int kMostFeatures = 400;
constexpr double kBorder_px = 14;
constexpr float kNearestOfSecond = 0.8F;  // distances between descriptors

cv::Mat rows_of(const DescribedFeatures& features) {
  return cv::Mat(static_cast<int>(features.raw_px.size()), kDescriptorBytes, CV_8U,
                 const_cast<std::uint8_t*>(features.descriptors.data()));  // NOLINT: only read
}

// The nearest of `to` for each of `from`, where it is so by far; else -1.
std::vector<int> nearest(const cv::Mat& from, const cv::Mat& to) {
  std::vector<std::vector<cv::DMatch>> found;
  cv::BFMatcher(cv::NORM_L2).knnMatch(from, to, found, 2);
  std::vector<int> out;
  out.reserve(found.size());
  for (const auto& m : found) {
    const bool clear = m.size() == 2 && m[0].distance < kNearestOfSecond * m[1].distance;
    out.push_back(clear ? m[0].trainIdx : -1);
  }
  return out;
}

}  // namespace

MotionField wide_baseline_motion(const cv::Mat& before, const cv::Mat& newest) {
  const DescribedFeatures from = describe(before, kMostFeatures, kBorder_px);
  const DescribedFeatures to = describe(newest, kMostFeatures, kBorder_px);
  MotionField out;
  if (from.raw_px.empty() || to.raw_px.empty()) return out;
  const std::vector<int> forward = nearest(rows_of(from), rows_of(to)), back = nearest(rows_of(to), rows_of(from));
  for (std::size_t i = 0; i < forward.size(); ++i) {
    if (forward[i] < 0 || back[static_cast<std::size_t>(forward[i])] != static_cast<int>(i)) continue;
    out.add(from.raw_px[i], to.raw_px[static_cast<std::size_t>(forward[i])] - from.raw_px[i]);
  }
  return out;
}

}  // namespace coslam
