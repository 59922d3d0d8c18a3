// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

namespace coslam {

// Whether odd rows were taken at another time than even ones, as of interlaced video while something moves: rows are
// then more like the next one of their own field than like their neighbours. CV_8UC3.
bool is_combed(const cv::Mat& bgr);

// Every second row anew, halfway between those above and below: what is left is of one time. CV_8UC3.
void keep_one_field(cv::Mat& bgr);

}  // namespace coslam
