// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "agent/track/tracker.h"
#include "agent/track/working_scale.h"

namespace coslam {
namespace {

constexpr double kPatchScale = 0.3;

float sample(const cv::Mat& image, float x, float y) {
  x = std::clamp(x, 0.0f, static_cast<float>(image.cols - 1));
  y = std::clamp(y, 0.0f, static_cast<float>(image.rows - 1));
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const int x1 = std::min(x0 + 1, image.cols - 1), y1 = std::min(y0 + 1, image.rows - 1);
  const float a = x - static_cast<float>(x0), b = y - static_cast<float>(y0);
  const std::uint8_t* top = image.ptr<std::uint8_t>(y0);
  const std::uint8_t* bottom = image.ptr<std::uint8_t>(y1);
  const float upper = static_cast<float>(top[x0]) * (1 - a) + static_cast<float>(top[x1]) * a;
  const float lower = static_cast<float>(bottom[x0]) * (1 - a) + static_cast<float>(bottom[x1]) * a;
  return upper * (1 - b) + lower * b;
}

}  // namespace

cv::Mat shrink_for_patches(const cv::Mat& grey) {
  // Exactly 30 %, not the rounded size. Averaging two by two and then interpolating takes a tenth of the time of
  // averaging over areas that are not whole pixels.
  return scaled_image(scaled_image(grey, 0.5), 2 * kPatchScale);
}

ImagePatch cut_patch(const cv::Mat& small, const Track& track) {
  // Pixel centres are at integers, so the corner of the image, at -0.5, is the fixed point of the scaling.
  const float scale = static_cast<float>(kPatchScale);
  const float cx = (track.raw_px.x() + 0.5f) * scale - 0.5f;
  const float cy = (track.raw_px.y() + 0.5f) * scale - 0.5f;
  constexpr int kHalf = kPatchSide / 2;
  ImagePatch patch;
  patch.track = track.id;
  auto* out = patch.grey.data();
  for (int dy = -kHalf; dy <= kHalf; ++dy) {
    for (int dx = -kHalf; dx <= kHalf; ++dx) {
      *out++ = static_cast<std::uint8_t>(
          std::lround(sample(small, cx + static_cast<float>(dx), cy + static_cast<float>(dy))));
    }
  }
  patch.grey = quantised_patch(patch.grey);
  return patch;
}

}  // namespace coslam
