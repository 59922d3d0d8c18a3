// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>

#include "agent/capture/source.h"

namespace coslam {

// The image of a file as CV_8UC1; empty when it is missing, truncated or no image.
cv::Mat read_grey(const std::filesystem::path& file);

// CV_8UC1 of a frame as a video or camera delivers it; empty for a format that is none.
cv::Mat to_grey(const cv::Mat& frame);

// Throws UserError when the source's first image has not the calibration's size.
void require_size(const cv::Mat& image, const SourceOptions& options, const std::string& image_name);

}  // namespace coslam
