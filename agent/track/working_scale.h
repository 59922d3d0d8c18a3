// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>

#include "agent/track/tracker_config.h"

namespace coslam {

// Pixel centres are at whole numbers, so the corner of the image, at -0.5, is the fixed point of a scaling.
Eigen::Vector2f scaled_px(const Eigen::Vector2f& px, double scale);

// The image `scale` times as large; itself where that is 1.
cv::Mat scaled_image(const cv::Mat& grey, double scale);

// The image at another size: that of scaled_image() for some scale, but for rounding.
cv::Mat image_of_size(const cv::Mat& grey, const cv::Size& size);

// Position of a track in the image before and in the newest; pixels of these images.
struct MovedPlace {
  Eigen::Vector2f from_px, to_px;
};

// How much less surely places are known in images of half the size: the median ratio of their standard deviations, both
// in pixels of the whole image. A window's place is known to sigma / sqrt(lambda), lambda the smaller eigenvalue of its
// structure tensor and sigma what is left between two aligned windows: noise, and all that the model of alignment
// lacks. A sharp, clean image loses a factor of 2 and more; one that is soft, or so noisy that averaging gains what
// detail is lost, close to 1. Empty where too few places tell.
std::optional<double> loss_by_halving(const cv::Mat& before, const cv::Mat& newest, std::span<const MovedPlace> places);

// The size at which a camera's images are tracked in, against the raw ones. The tracker's windows are so many pixels,
// whatever they show: images wider than most_width_px are shrunk, which costs their finest detail and saves time, and
// small ones are doubled. Between that size and about half of it the images decide: where they hold little detail, the
// smaller ones track as surely, longer, and in less time. Pure; thread-compatible.
class WorkingScale {
 public:
  WorkingScale(int width_px, const TrackerConfig& config);

  double now() const { return coarse_is_enough_ ? coarse_ : finest_; }
  double finest() const { return finest_; }

  // Whether this image is to be compared with its half; to be asked once for each image after the first.
  bool due();
  // Takes the result of loss_by_halving() at the finest scale.
  void compared(double loss);

 private:
  double finest_, coarse_;
  bool coarse_is_enough_ = false;
  int images_ = 0, comparisons_ = 0;
  double loss_ = 0;  // lately
};

}  // namespace coslam
