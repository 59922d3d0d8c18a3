// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "common/model/track_frame.h"

namespace coslam {

struct DescribedFeatures {
  std::vector<Eigen::Vector2f> raw_px;
  std::vector<std::uint8_t> descriptors;  // kDescriptorBytes each
};

// SIFT features of an image (D. Lowe, 2004), the strongest `most`, at least border_px from its edge, no two closer than
// 3 px. Values as quantised_descriptor() leaves them.
DescribedFeatures describe(const cv::Mat& grey, int most, double border_px);

// Describes only features that lie within near_px of these places.
DescribedFeatures describe_near(const cv::Mat& grey, const std::vector<Eigen::Vector2f>& raw_px, float near_px,
                                int most, double border_px);

}  // namespace coslam
