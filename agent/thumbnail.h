// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace coslam {

inline constexpr int kThumbnailWidth_px = 192;  // maximum of the longer side

// A JPEG image of kMostThumbnailBytes at most. image: CV_8UC1; one without pixels gives no octets.
std::vector<std::uint8_t> thumbnail_jpeg(const cv::Mat& image);

}  // namespace coslam
