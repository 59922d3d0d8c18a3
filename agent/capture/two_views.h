// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace coslam {

// The picture is that of two cameras that look one way, beside each other, as stereo cameras give them: most of what
// its left half shows is in the right half, in the same rows and at about the same distance along them. Nothing is
// said of what shows hardly any corners.
bool shows_two_views(const cv::Mat& grey);

// Advice to the user on making two sources of pictures that wide.
std::string how_to_split(int width_px);

}  // namespace coslam
