// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "agent/capture/fields.h"

namespace coslam::test {

// What a camera sees that was at this place, with its sensor's noise.
inline cv::Mat view(double x_px, int seed = 1) {
  cv::Mat coarse(40, 90, CV_8UC1), wall, image, noise(240, 360, CV_16SC1);
  cv::RNG(3).fill(coarse, cv::RNG::UNIFORM, 20, 230);
  cv::resize(coarse, wall, {720, 320}, 0, 0, cv::INTER_CUBIC);
  const cv::Mat move = (cv::Mat_<double>(2, 3) << 1, 0, -x_px, 0, 1, -0.3 * x_px);
  cv::warpAffine(wall, image, move, noise.size(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  cv::RNG(static_cast<std::uint64_t>(seed)).fill(noise, cv::RNG::NORMAL, 0, 2);
  cv::add(image, noise, image, {}, CV_8U);
  return image;
}

inline double place_px(double frame) { return 3 * frame + 0.3 * frame * frame; }

// Odd rows are of half a frame later, or even ones.
inline cv::Mat interlaced(int frame, Fields order) {
  cv::Mat image = view(place_px(frame), frame);
  const cv::Mat later = view(place_px(frame + 0.5), frame);
  for (int y = order == Fields::kUpperFirst ? 1 : 0; y < image.rows; y += 2) later.row(y).copyTo(image.row(y));
  return image;
}

}  // namespace coslam::test
