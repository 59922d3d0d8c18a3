// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "common/base/time.h"

// What cyclone_camera says, computed here.
namespace coslam::test {

constexpr int kKindsOfImage = 8;
constexpr TimeNs kFirstStamp_ns = 1'700'000'000'000'000'007, kStampStep_ns = 1'000'000;

// The number of an image by its stamp; -1: it has none like that.
inline long number_of(TimeNs stamp_ns) {
  const TimeNs since_ns = stamp_ns - kFirstStamp_ns;
  return since_ns < 0 || since_ns % kStampStep_ns != 0 ? -1 : static_cast<long>(since_ns / kStampStep_ns);
}

// Grey of image `number`, whose encoding is mono8, bgr8 or yuyv.
inline cv::Mat grey_image(long number, int width, int height, const std::string& encoding) {
  const int channels = encoding == "bgr8" ? 3 : encoding == "yuyv" ? 2 : 1;
  cv::Mat octets(height, width, CV_8UC(channels));
  for (unsigned i = 0; i < static_cast<unsigned>(octets.total()) * static_cast<unsigned>(channels); ++i)
    octets.data[i] = static_cast<uchar>(7 * i + i / 256 + 31 * static_cast<unsigned>(number % kKindsOfImage));
  cv::Mat grey = octets;
  if (encoding == "bgr8") cv::cvtColor(octets, grey, cv::COLOR_BGR2GRAY);
  if (encoding == "yuyv") cv::extractChannel(octets, grey, 0);
  return grey;
}

inline bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

}  // namespace coslam::test
