// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "agent/track/motion.h"

namespace coslam {

// Finds places of one image in another that may be anywhere as long as the two overlap: features of both matched by
// their descriptors, each the other's nearest and by far. Takes as long as describing both. CV_8UC1, of one size.
MotionField wide_baseline_motion(const cv::Mat& before, const cv::Mat& newest);

}  // namespace coslam
