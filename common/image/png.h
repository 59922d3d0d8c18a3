// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "common/image/wanted.h"

namespace coslam::png {

bool is_png(std::span<const std::uint8_t> octets);
// Decodes a PNG; empty: it is damaged.
cv::Mat decode(std::span<const std::uint8_t> octets, Wanted wanted);
// Encodes CV_8U or CV_16U with 1, 3 or 4 channels; empty: it cannot be.
std::vector<std::uint8_t> encode(const cv::Mat& image);

}  // namespace coslam::png
