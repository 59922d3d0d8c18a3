// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "common/image/wanted.h"

namespace coslam::jpeg {

bool is_jpeg(std::span<const std::uint8_t> octets);
// Decodes a JPEG; empty: it is damaged, or for print (CMYK).
cv::Mat decode(std::span<const std::uint8_t> octets, Wanted wanted);
// Encodes CV_8UC1 or CV_8UC3; empty: it cannot be.
std::vector<std::uint8_t> encode(const cv::Mat& image, int quality, bool optimize);

}  // namespace coslam::jpeg
